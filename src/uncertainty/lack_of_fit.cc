#include "src/uncertainty/lack_of_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/format.h"
#include "src/common/scaled_eigensystem.h"
#include "src/common/text.h"
#include "src/uncertainty/looks.h"
#include "src/uncertainty/residual_gram.h"
#include "src/uncertainty/residual_structure.h"
#include "src/uncertainty/structure_columns.h"

namespace alidade::internal {
namespace {

// What a prediction takes in, and what is worth a warning.
constexpr double kTakenIn = 0.05;
constexpr double kWarned = 0.005;
constexpr double kLeastRatio = 1.05;
// Repeats of less spread, in sigmas squared, are copies.
constexpr double kNoSpread = 1e-6;
// Residuals of exact data (m, rad).
constexpr double kExact = 1e-9;

// A class of rows: what its residuals have beyond the noise.
struct ClassExcess {
  NoiseSource source = NoiseSource::kNone;
  double squares = 0.0;  // mean, over degrees of freedom, in sigmas squared
  double freedom = 0.0;
  double noise = 0.0;      // of one measurement, in sigmas squared
  double precision = 0.0;  // mean of 1 / sigma^2
  double p_value = std::numeric_limits<double>::quiet_NaN();
  double excess = 0.0;          // variance (m^2, rad^2), significant or not
  double excess_freedom = 0.0;  // of it
  double residual = 0.0;        // of one measurement, in sigmas squared

  bool is_known() const { return source != NoiseSource::kNone; }
  bool is_taken_in() const { return p_value < kTakenIn; }
};

class Assessor {
 public:
  Assessor(const FittedProblem& fit, const ParameterCovariance& covariance,
           const StatedNoise& stated, bool has_repeats)
      : fit_(fit),
        covariance_(covariance),
        stated_(stated),
        looks_(TakeLooks(fit, has_repeats)),
        structure_(fit.model, fit.values, looks_.data, looks_.residuals.size(),
                   !looks_.is_sample),
        gram_(SumLooks(fit, looks_, structure_, covariance.root)),
        plain_(fit, gram_),
        with_structure_(plain_) {}

  LackAssessment Run() {
    result_.prediction = covariance_;
    result_.lack.is_sample = looks_.is_sample;
    result_.lack.looks = static_cast<std::int64_t>(looks_.counts.size());
    if (plain_.AllFreedom() >= 1.0) {
      if (!IsExact()) {
        result_.lack.structure =
            FindStructure(structure_.families(), &with_structure_);
      }
      const ClassExcess lengths = Compare(kLengths);
      const ClassExcess rotations = Compare(kRotations);
      Fill(lengths, rotations);
      TakeIn(lengths, rotations);
      WarnOfLack(lengths.freedom > 0.0 ? lengths : rotations);
      WarnOfStructure();
    }
    FindRobustDeviations();
    return std::move(result_);
  }

 private:
  Eigen::VectorXd PriorPrecisions() const {
    return FreePriors(fit_).array().square().inverse();
  }

  // Rows of the whole data set for each that was looked at.
  double SampleFactor() const {
    double counted = 0.0;
    for (const int count : looks_.counts) counted += count;
    return std::max(
        1.0, static_cast<double>(fit_.data.global_observations()) / counted);
  }

  bool HasStructure() const {
    return !result_.lack.structure.empty() &&
           result_.lack.structure.front().is_found;
  }

  // Of data without noise rounding alone is left, in which there is structure.
  bool IsExact() const {
    const double rows = gram_.rows[kLengths] + gram_.rows[kRotations];
    const double precision =
        (gram_.precision[kLengths] + gram_.precision[kRotations]) / rows;
    const double mean = plain_.AllSquares() / plain_.AllFreedom();
    const bool is_far_below =
        stated_ && (*stated_)[kLengths] == 1.0 && mean < kMuchSmaller;
    return is_far_below || mean < kExact * kExact * precision;
  }

  ClassExcess Compare(int which) const {
    ClassExcess one;
    const double freedom = plain_.Freedom(which);
    if (!(gram_.rows[which] > 0.0) || freedom < 1.0) return one;
    one.freedom = freedom;
    one.squares = plain_.Squares(which) / freedom;
    one.precision = gram_.precision[which] / gram_.rows[which];
    const double of_mean = gram_.inverse_counts[which] / gram_.rows[which];
    double repeat_freedom = kInfinity;
    const double spread = looks_.repeat_squares[which] /
                          std::max(1.0, looks_.repeat_freedom[which]);
    if (looks_.repeat_freedom[which] >= kFewestRepeats && spread > kNoSpread) {
      one.source = NoiseSource::kRepeats;
      repeat_freedom = looks_.repeat_freedom[which];
      one.noise = spread;
    } else if (stated_) {
      one.source = NoiseSource::kStated;
      one.noise = (*stated_)[which];
    } else if (HasStructure() && with_structure_.Freedom(which) >= 1.0) {
      one.source = NoiseSource::kStructure;
      one.noise = with_structure_.Squares(which) /
                  with_structure_.Freedom(which) / of_mean;
      one.p_value = result_.lack.structure.front().p_value;
    }
    one.residual = one.squares;
    if (!one.is_known()) return one;
    const double beyond = one.squares - one.noise * of_mean;
    if (one.source != NoiseSource::kStructure) {
      one.p_value = FisherSurvival(one.squares / (one.noise * of_mean), freedom,
                                   repeat_freedom);
    }
    one.excess = std::max(0.0, beyond) / one.precision;
    const double of_noise = one.noise * of_mean;
    one.excess_freedom = beyond * beyond /
                         (one.squares * one.squares / freedom +
                          of_noise * of_noise / repeat_freedom);
    one.residual = std::max(0.0, one.noise + beyond);
    return one;
  }

  void Fill(const ClassExcess& lengths, const ClassExcess& rotations) {
    LackOfFit& lack = result_.lack;
    const ClassExcess& first = lengths.freedom > 0.0 ? lengths : rotations;
    lack.source = first.source;
    lack.degrees_of_freedom = first.freedom;
    lack.p_value = first.p_value;
    if (lengths.precision > 0.0) {
      lack.noise = std::sqrt(lengths.noise / lengths.precision);
      lack.residual = std::sqrt(lengths.residual / lengths.precision);
    }
    constexpr double kAxes = 3.0;
    if (lengths.is_taken_in()) {
      lack.excess_variance = kAxes * lengths.excess;
      lack.excess_degrees_of_freedom = lengths.excess_freedom;
    }
    if (rotations.is_taken_in()) {
      lack.rotation_excess_variance = kAxes * rotations.excess;
    }
  }

  // What a robust loss takes away is noise of others as well.
  double NoiseRatio(const ClassExcess& one) const {
    const bool is_robust =
        covariance_.is_sandwich ||
        (covariance_.terms != nullptr && !fit_.losses.empty());
    return is_robust ? std::max(one.noise, 1.0 - one.excess * one.precision)
                     : one.noise;
  }

  // Whether repeats scatter by more than the stated sigma explains: each
  // measurement then says less, even where the model lacks nothing.
  bool IsNoisier(int which, const ClassExcess& one) const {
    return one.source == NoiseSource::kRepeats && one.noise > 1.0 &&
           FisherSurvival(one.noise, looks_.repeat_freedom[which], kInfinity) <
               kTakenIn;
  }

  // Into predictions.
  void TakeIn(const ClassExcess& lengths, const ClassExcess& rotations) {
    ModelExcess& excess = result_.prediction.excess;
    excess.noise =
        lengths.is_known() ? result_.lack.noise : result_.lack.residual;
    if (lengths.is_taken_in()) {
      excess.length = lengths.excess;
      excess.noise_ratio[kLengths] = NoiseRatio(lengths);
    }
    if (rotations.is_taken_in()) {
      excess.rotation = rotations.excess;
      excess.noise_ratio[kRotations] = NoiseRatio(rotations);
    }
    // With error terms the parameters' own part is no inverse information, and
    // predictions take the root of both together.
    const bool is_noisier = IsNoisier(kLengths, lengths);
    result_.differs = (excess.is_there() || is_noisier) &&
                      !covariance_.is_sandwich && covariance_.terms == nullptr;
    if (!result_.differs) return;
    const double noise =
        lengths.is_taken_in() || is_noisier ? lengths.noise : 1.0;
    const double sample = SampleFactor();
    Eigen::MatrixXd filling =
        sample *
        (noise * gram_.information + excess.length * gram_.common[kLengths] +
         excess.rotation * gram_.common[kRotations]);
    filling.diagonal() += PriorPrecisions();
    result_.prediction.root =
        covariance_.root *
        (covariance_.root.transpose() * ScaledEigensystem(filling).Root());
    result_.prediction.degrees_of_freedom =
        std::min(covariance_.degrees_of_freedom, plain_.AllFreedom());
  }

  // What the model lacks is alike at neighbouring configurations: blocks of
  // these say how much more it takes than if each were off by itself.
  void FindRobustDeviations() {
    result_.robust_std = RobustDeviations(gram_.scores, SampleFactor());
    const std::vector<int> blocks =
        BlocksOfNeighbours(looks_, covariance_.size());
    if (!blocks.empty()) {
      const int count = 1 + *std::max_element(blocks.begin(), blocks.end());
      Eigen::MatrixXd scores =
          Eigen::MatrixXd::Zero(gram_.scores.rows(), count);
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        scores.col(blocks[k]) += gram_.scores.col(static_cast<Eigen::Index>(k));
      }
      // Each block has taken a part in the fit.
      const double left = 1.0 - static_cast<double>(covariance_.size()) / count;
      // More configurations between those of a sample would not take away what
      // neighbours have in common.
      const Eigen::ArrayXd common =
          RobustDeviations(scores / std::sqrt(left), 1.0).array().square() -
          RobustDeviations(gram_.scores, 1.0).array().square();
      result_.robust_std =
          (result_.robust_std.array().square() + common.max(0.0)).sqrt();
    }
    for (int k = 0; k < covariance_.size(); ++k) {
      if (!covariance_.IsTold(k)) result_.robust_std[k] = kInfinity;
    }
  }

  // `scores`: of each block of observations, of which there are `sample` times
  // as many as were looked at.
  Eigen::VectorXd RobustDeviations(const Eigen::MatrixXd& scores,
                                   double sample) const {
    const Eigen::VectorXd prior = PriorPrecisions();
    Eigen::MatrixXd bread = sample * gram_.information;
    Eigen::MatrixXd filling = sample * scores * scores.transpose();
    bread.diagonal() += prior;
    filling.diagonal() += prior;
    constexpr double kNotDetermined = 1e-12;
    int rank = 0;
    const Eigen::MatrixXd root =
        ScaledEigensystem(bread).PseudoInverse(kNotDetermined, &rank) *
        ScaledEigensystem(filling).Root();
    return root.rowwise().norm();
  }

  void WarnOfLack(const ClassExcess& one) {
    const bool is_measured = one.source == NoiseSource::kStated ||
                             one.source == NoiseSource::kRepeats;
    const double ratio = std::sqrt(one.residual / one.noise);
    if (!is_measured || !(one.p_value < kWarned) || !(ratio > kLeastRatio)) {
      return;
    }
    const LackOfFit& lack = result_.lack;
    const bool by_repeats = one.source == NoiseSource::kRepeats;
    std::string text = "residuals are " + FormatSignificant(ratio, 2) +
                       " times the " +
                       (by_repeats ? "repeatability" : "stated sigma");
    if (lack.noise > 0.0) text += " (" + FormatLength(lack.noise, 2) + ")";
    text += ": the arm has errors that its parameters do not describe";
    if (!by_repeats) text += ", or sigma is stated too small";
    if (lack.excess_variance > 0.0) {
      text += ". Predictions contain them (" +
              FormatLength(std::sqrt(lack.excess_variance), 2) +
              " of a position)";
    }
    if (!by_repeats) {
      text += ". Measure some poses several times: their spread is the noise";
    }
    result_.warnings.push_back(std::move(text));
  }

  void WarnOfStructure() {
    constexpr std::size_t kMostNamed = 4;
    std::vector<std::string> others;
    const std::vector<StructureTest>& tests = result_.lack.structure;
    if (!HasStructure()) return;
    for (std::size_t k = 1;
         k < std::min(kMostNamed, tests.size()) && tests[k].is_found; ++k) {
      others.push_back(NameOf(tests[k]));
    }
    std::string text =
        "the residuals depend on " + NameOf(tests.front()) + " (" +
        FixedNumber(100.0 * tests.front().explained, 0) +
        " % of their sum of squares, corrected p " +
        (tests.front().p_value < 1e-16
             ? "< 1e-16"
             : "= " + FormatSignificant(tests.front().p_value, 2)) +
        ")";
    if (!others.empty()) text += ", and on " + Join(others, ", ");
    text += std::string(": ") + CureOf(tests.front().kind);
    result_.warnings.push_back(std::move(text));
  }

  static const char* CureOf(StructureKind kind) {
    switch (kind) {
      case StructureKind::kJointValue:
        return "an eccentric encoder or gear, or elasticity. Look at that "
               "joint, and measure poses over the range where the arm works";
      case StructureKind::kJointRipple:
        return "a gear that ripples. Measure more poses, and do not trust "
               "single ones";
      case StructureKind::kGravityMoment:
        return "elasticity, the joint gives way under load. Measure with the "
               "payload and in the region where the arm works";
      case StructureKind::kGravitySign:
        return "backlash that gravity takes up. Have the joint looked at, or "
               "work where the load stays on one side";
      case StructureKind::kApproach:
        return "backlash or friction. Approach all poses from the same side, "
               "here and at work";
      case StructureKind::kRowOrder:
        return "thermal growth, or the base or the instrument moves. Let the "
               "arm and the instrument warm up, measure in less time, and "
               "measure one pose again and again in between";
      case StructureKind::kCovariate:
        return "name it among `columns: {covariates: [...]}` and choose "
               "`errors: auto`, which moves the base with it, or keep it as "
               "it is where the arm works";
    }
    return "";
  }

  const FittedProblem& fit_;
  const ParameterCovariance& covariance_;
  const StatedNoise stated_;
  const Looks looks_;
  const StructureColumns structure_;
  const ResidualGram gram_;
  const StructureFit plain_;
  StructureFit with_structure_;
  LackAssessment result_;
};

}  // namespace

std::string NameOf(const StructureTest& test) {
  const std::string of_joint = test.joint > 0
                                   ? " of joint " + std::to_string(test.joint)
                                   : " of the joints";
  switch (test.kind) {
    case StructureKind::kJointValue:
      return "the value" + of_joint;
    case StructureKind::kJointRipple:
      return "a ripple with the value" + of_joint;
    case StructureKind::kGravityMoment:
      return "the gravity moment" + of_joint;
    case StructureKind::kGravitySign:
      return "the sign of the gravity moment" + of_joint;
    case StructureKind::kApproach:
      return "the approach direction" + of_joint;
    case StructureKind::kRowOrder:
      return "the order of rows";
    case StructureKind::kCovariate:
      return "`" + test.covariate + "`";
  }
  return "";
}

LackAssessment AssessLackOfFit(const FittedProblem& fit,
                               const ParameterCovariance& covariance,
                               const StatedNoise& stated, bool has_repeats) {
  if (covariance.size() == 0) {
    LackAssessment nothing;
    nothing.prediction = covariance;
    return nothing;
  }
  return Assessor(fit, covariance, stated, has_repeats).Run();
}

}  // namespace alidade::internal
