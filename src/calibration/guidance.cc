#include "src/calibration/guidance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "src/calibration/acceptance.h"
#include "src/calibration/improvement.h"
#include "src/common/format.h"
#include "src/common/text.h"

namespace alidade::internal {
namespace {

// Of more observations the extremes are not looked for.
constexpr Eigen::Index kMostLookedAt = 1'000'000;
// Accuracy that differs by less is the same everywhere.
constexpr double kSame = 1.02;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Finding Passed(std::string key, double statistic, std::string sentence,
               std::string next = "") {
  return {std::move(key),        statistic,      kNone, std::move(sentence),
          FindingLevel::kPassed, std::move(next)};
}

// "312, -40, 905 mm from its base".
std::string PlaceOf(const Arm& arm, const Eigen::Vector3d& in_instrument) {
  const Eigen::Vector3d place =
      Eigen::Isometry3d(arm.instrument_from_base).inverse() * in_instrument;
  std::string text;
  for (const double value : place) {
    text += (text.empty() ? "" : ", ") + FixedNumber(value / kMillimetre, 0);
  }
  return "x, y, z = " + text + " mm in the frame of its base";
}

// "12, -80, 31 deg", with a unit each where joints turn and slide.
std::string JointValuesOf(const Arm& arm, const Eigen::VectorXd& values) {
  const auto turns = [&arm](int j) {
    return arm.joints[static_cast<std::size_t>(j)].type == JointType::kRevolute;
  };
  bool all_turn = true;
  for (int j = 0; j < arm.num_joints(); ++j) all_turn &= turns(j);
  std::string text;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const double unit = turns(j) ? kDegree : kMillimetre;
    text += (j > 0 ? ", " : "") + FixedNumber(values[j] / unit, 0);
    if (!all_turn) text += turns(j) ? " deg" : " mm";
  }
  return text + (all_turn ? " deg" : "");
}

// "half of the position errors are within 0.14 mm, 95 of 100 within 0.31 mm,
// all within 0.42 mm".
std::string SpreadOf(const std::string& what, const Accuracy& errors,
                     Dimension dimension) {
  const auto shown = [dimension](double value) {
    return dimension == Dimension::kLength
               ? FormatLength(value, 3)
               : FormatSignificant(value / kDegree, 3) + " deg";
  };
  return "half of the " + what + " are within " + shown(errors.median) +
         ", 95 of 100 within " + shown(errors.p95) + ", all within " +
         shown(errors.max);
}

class Guide {
 public:
  explicit Guide(const CalibrationResult& result)
      : result_(result),
        judged_(JudgedSet(result)),
        errors_(judged_.Judged()),
        is_validated_(&judged_ != &result.train) {
    if (result.uncertainty && result.uncertainty->workspace) {
      map_ = &*result.uncertainty->workspace;
    }
  }

  std::vector<Finding> Findings() {
    AddAccuracy();
    AddWorstPlace();
    AddValidation();
    AddMotions();
    AddCoverage();
    AddLimit();
    return std::move(findings_);
  }

 private:
  const char* Set() const { return is_validated_ ? "validation" : "training"; }
  std::string Poses() const { return std::string(Set()) + " poses"; }

  bool LacksLimits() const {
    const std::vector<Joint>& joints = result_.arm.joints;
    return std::any_of(joints.begin(), joints.end(), [](const Joint& joint) {
      return joint.type == JointType::kRevolute && !HasLimits(joint);
    });
  }

  // The budget of a region that the job states; null where it states none.
  const UncertaintyBudget* StatedRegion() const {
    if (!result_.uncertainty || !result_.uncertainty->budget ||
        result_.uncertainty->budget->region.empty()) {
      return nullptr;
    }
    return &*result_.uncertainty->budget;
  }

  void AddAccuracy() {
    // A fit's own errors are smaller than those of what it was made without.
    const bool is_folded = !is_validated_ && result_.cross_validation;
    const ValidationErrors judged =
        is_folded ? ValidationErrorsOf(result_)
                  : ValidationErrors{errors_.after, errors_.rotation_after};
    const bool has_lengths = judged.lengths.n > 0;
    if (!has_lengths && judged.rotations.n == 0) return;
    std::string text = is_folded
                           ? "Of poses that were left out of the fit in turn "
                           : "At " + Poses() + " ";
    if (has_lengths) {
      text += SpreadOf(std::string(LengthErrorName(result_)) + "s",
                       judged.lengths, Dimension::kLength);
    }
    if (judged.rotations.n > 0) {
      text +=
          (has_lengths ? "; " : "") +
          SpreadOf("orientation errors", judged.rotations, Dimension::kAngle);
    }
    text += ", the noise of the measurement included.";
    if (const UncertaintyBudget* const budget = StatedRegion()) {
      text += " In the task region that the job states, " +
              FormatSignificant(100.0 * budget->confidence, 3) +
              " % of positions are within " +
              FormatLength(budget->position.expanded_distance, 3) +
              " of where the calibrated arm says, and no coordinate has a "
              "standard uncertainty above " +
              FormatLength(budget->worst_std, 3) + ".";
    }
    if (map_ != nullptr && map_->summary.n > 0) {
      text += " Over the whole workspace" +
              std::string(LacksLimits() ? " (whole turns of joints for which "
                                          "the arm file states no limits)"
                                        : "") +
              " a standard deviation of " +
              FormatLength(map_->summary.median, 3) +
              " is predicted (median), at most " +
              FormatLength(map_->summary.p95, 3) + " at 95 of 100 places.";
    }
    const Accuracy& first = has_lengths ? judged.lengths : judged.rotations;
    findings_.push_back(Passed("accuracy", first.p95, std::move(text)));
  }

  void AddWorstPlace() {
    const std::string predicted = PredictedWorst();
    const std::string measured = MeasuredWorst();
    if (predicted.empty() && measured.empty()) return;
    findings_.push_back(
        Passed("worst_place",
               predicted.empty() ? errors_.after.max : map_->summary.max,
               predicted + (predicted.empty() || measured.empty() ? "" : " ") +
                   measured));
  }

  std::string PredictedWorst() const {
    if (map_ == nullptr || map_->position_std.size() == 0 ||
        map_->positions.cols() != map_->position_std.size() ||
        map_->joint_values.rows() != result_.arm.num_joints()) {
      return "";
    }
    Eigen::Index worst = 0;
    const double largest = map_->position_std.maxCoeff(&worst);
    const double median = map_->summary.median;
    if (!std::isfinite(largest) || !(median > 0.0)) return "";
    if (largest < kSame * median) {
      return "The predicted standard deviation is the same over the whole "
             "workspace, " +
             FormatLength(largest, 3) + ".";
    }
    return "Of the whole workspace the arm is predicted to be least accurate "
           "at " +
           PlaceOf(result_.arm, map_->positions.col(worst)) + " (joints at " +
           JointValuesOf(result_.arm, map_->joint_values.col(worst)) +
           "): a standard deviation of " + FormatLength(largest, 3) + ", " +
           FormatSignificant(largest / median, 2) + " times the median.";
  }

  // Of the observations that the result is judged by, the one that has the
  // largest error.
  std::string MeasuredWorst() const {
    const Eigen::Index size = judged_.residual_after.cols();
    if (errors_.after.n == 0 || size == 0 || size > kMostLookedAt) {
      return "";
    }
    Eigen::Index worst = -1;
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < size; ++i) {
      const double off =
          std::abs(judged_.residual_after.col(i).norm() - errors_.after.max);
      if (off < nearest) {
        nearest = off;
        worst = i;
      }
    }
    if (worst < 0) return "";
    std::string text = "The largest error at " + Poses() + ", " +
                       FormatLength(errors_.after.max, 3) + ", was measured";
    if (judged_.positions.cols() == size &&
        judged_.positions.col(worst).allFinite()) {
      text += " at " + PlaceOf(result_.arm, judged_.positions.col(worst));
    }
    if (judged_.labels.empty()) {
      return text + " (" + ObservationName(judged_, Set()) + " " +
             std::to_string(worst + 1) + ").";
    }
    const ObservationLabel& label =
        judged_.labels[static_cast<std::size_t>(worst)];
    if (label.pose >= 0) {
      text +=
          std::string(" (") + Set() + " pose " + std::to_string(label.pose + 1);
    }
    if (!label.where.empty()) {
      text += (label.pose >= 0 ? ", " : " (") + label.where;
    }
    return text + (label.pose >= 0 || !label.where.empty() ? ")." : ".");
  }

  void AddNext(double statistic, std::string sentence, std::string next) {
    findings_.push_back(Passed("next_measurement", statistic,
                               std::move(sentence), std::move(next)));
  }

  void AddValidation() {
    if (is_validated_ || result_.cross_validation) return;
    AddNext(kNone, "There are no poses that the fit did not use.",
            "Measure some 20 more over the region where the arm works, as "
            "`validation`.");
  }

  void AddMotions() {
    if (result_.identifiability.advice.empty()) return;
    AddNext(kNone, AsSentence(result_.identifiability.advice.front()),
            "Measure poses with such motions.");
  }

  // Where a joint was measured over less than this part of its range, the arm
  // is extrapolated to beyond.
  void AddCoverage() {
    constexpr double kFullEnough = 0.6;
    constexpr double kTurn = 2.0 * kPi;
    const auto& values = result_.train.joint_values;
    if (values.cols() == 0 || values.cols() > kMostLookedAt ||
        values.rows() != result_.arm.num_joints()) {
      return;
    }
    std::vector<std::string> joints;
    double least = 1.0;
    for (int j = 0; j < result_.arm.num_joints(); ++j) {
      const Joint& joint = result_.arm.joints[static_cast<std::size_t>(j)];
      if (!HasLimits(joint) && joint.type != JointType::kRevolute) continue;
      const auto row = values.map().row(j);
      // Beyond a turn the geometry is the same again.
      const double range =
          joint.type == JointType::kRevolute
              ? std::min(HasLimits(joint) ? joint.upper - joint.lower : kTurn,
                         kTurn)
              : joint.upper - joint.lower;
      const double part = (row.maxCoeff() - row.minCoeff()) / range;
      if (!(part < kFullEnough)) continue;
      joints.push_back(std::to_string(j + 1) + " (" +
                       FixedNumber(100.0 * part, 0) + " %)");
      least = std::min(least, part);
    }
    if (joints.empty()) return;
    AddNext(least,
            "Only a part of the range was measured of " +
                std::string(joints.size() == 1 ? "joint " : "joints ") +
                Join(joints, ", ") +
                (LacksLimits() ? ", of a whole turn where the arm file states "
                                 "no limits."
                               : "."),
            "Measure where the arm works beyond it, or do not rely on the "
            "arm there.");
  }

  // Whether more poses would help.
  void AddLimit() {
    const PredictionParts* parts = nullptr;
    if (map_ != nullptr) parts = &map_->parts;
    if (parts == nullptr || !(parts->from_parameters > 0.0)) return;
    // Far more than where the arm was measured: these poses say nothing of
    // others.
    constexpr double kFarMore = 5.0;
    const double elsewhere = map_->summary.median;
    if (errors_.after.n > 0 && elsewhere > kFarMore * errors_.after.rms) {
      AddNext(elsewhere / errors_.after.rms,
              "Where the arm was not measured it is not known well: over the "
              "whole workspace a standard deviation of " +
                  FormatLength(elsewhere, 3) +
                  " is predicted, and the RMS error at " + Poses() + " is " +
                  FormatLength(errors_.after.rms, 3) + ".",
              "Rely on the arm only where it was measured, or measure over the "
              "whole range of its joints; `alidade plan` chooses poses.");
      return;
    }
    const double model = parts->from_model;
    const double ratio = model / parts->from_parameters;
    const std::string values =
        "Of the predicted error " + FormatLength(parts->from_parameters, 3) +
        " comes from the uncertainty of the parameters and " +
        (model > 0.0 ? FormatLength(model, 3) + " from what the model lacks"
                     : "nothing from what the model lacks");
    if (ratio > 1.0) {
      AddNext(ratio, values + ": more poses of the same kind hardly help.",
              result_.error_terms
                  ? "Measure with the payload, and in the region where the arm "
                    "works."
                  : "Let `errors: auto` weigh elasticity and errors of gears, "
                    "and measure with the payload.");
    } else {
      AddNext(ratio,
              values + ": four times as many poses would halve the former.",
              "If that is needed, measure more poses, near the worst place "
              "first; `alidade plan` chooses them.");
    }
  }

  const CalibrationResult& result_;
  const EvaluatedSet& judged_;
  const KeptErrors errors_;
  const bool is_validated_;
  const PredictedMap* map_ = nullptr;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> GuidanceOf(const CalibrationResult& result) {
  return Guide(result).Findings();
}

}  // namespace alidade::internal
