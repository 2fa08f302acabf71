#include "src/calibration/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/frame_fit.h"
#include "src/calibration/input_mistakes.h"
#include "src/calibration/position_sample.h"
#include "src/calibration/preparation.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/initialization/frame_start.h"
#include "src/kernel/partition.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// At the nominal geometry, of the reach.
constexpr double kTolerated = 0.02;
// A residual of a larger part of how far the positions lie apart explains
// nothing: an arm that hardly moves fits to any small cloud.
constexpr double kExplains = 0.2;
// After a calibration, of the reach and of how far the positions lie apart, at
// positions that it has not seen.
constexpr double kSolvedTolerated = 1e-3;
constexpr double kSolvedExplains = 0.02;
constexpr double kClearlyBetter = 4.0;
// Cures whose errors are closer than this explain the data alike.
constexpr double kAlike = 2.0;
// Cures that are looked at more closely, and of these those that are solved.
constexpr std::size_t kMostFitted = 60;
constexpr std::size_t kMostSolved = 8;
// Of the positions in such a calibration (m).
constexpr double kSigma = 1e-4;

// Median residual of the nominal arm with any base and tool (m).
double Misfit(const Arm& arm, const PositionSample& sample) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  std::vector<Eigen::Isometry3d> frames;
  ChainAxes axes;
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    ComputeChainAxes(in_base, sample.joint_values.col(i).data(), &axes);
    frames.push_back(axes.instrument_from_last);
  }
  const std::optional<PositionStart> start = StartFromPositions(
      frames, sample.points, std::vector<int>(frames.size(), 0), 1);
  return start ? start->misfit.median : kInfinity;
}

// The same with the target as the arm states it and a base that fits all of
// them best: one way to place the arm, found at a fraction of the cost of the
// best one.
double MisfitAsStated(const Arm& arm, const PositionSample& sample) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  Eigen::Matrix3Xd targets(3, sample.points.cols());
  ChainAxes axes;
  for (Eigen::Index i = 0; i < targets.cols(); ++i) {
    ComputeChainAxes(in_base, sample.joint_values.col(i).data(), &axes);
    targets.col(i) = axes.instrument_from_target.translation();
  }
  const std::optional<RigidFit> fit = FitRigid(targets, sample.points);
  if (!fit) return kInfinity;
  Eigen::VectorXd misfits =
      (fit->b_from_a * targets - sample.points).colwise().norm();
  if (!misfits.allFinite()) return kInfinity;
  double* const middle = misfits.data() + misfits.size() / 2;
  std::nth_element(misfits.data(), middle, misfits.data() + misfits.size());
  return *middle;
}

// Every third position, or all others.
PositionSample Part(const PositionSample& sample, bool held_out) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < sample.size(); ++k) {
    if ((k % 3 == 2) == held_out) columns.push_back(k);
  }
  PositionSample part;
  part.joint_values = sample.joint_values(Eigen::all, columns);
  part.points = sample.points(Eigen::all, columns);
  return part;
}

// The median error at a third of the positions of the arm that is calibrated
// with the others, base and tool with it (m).
double SolvedMisfit(const Arm& arm, const PositionSample& sample,
                    bool with_wide_priors = false) {
  const PositionSample fitted = Part(sample, false);
  const PositionSample others = Part(sample, true);
  const auto data = [](const PositionSample& part) {
    return MakePositions(
        part.joint_values, part.points,
        Eigen::Matrix3Xd::Constant(3, part.size(), kSigma).eval());
  };
  CalibrationTask task{arm, data(fitted), {}};
  task.options.identifiability.candidates = {true, true, true};
  if (!FitFrames(&task)) return kInfinity;
  const MeasurementModel model(task.arm);
  const IdentifiabilityOptions& options = task.options.identifiability;
  const Fit fit =
      FitPart(task, model, with_wide_priors ? WidenPriors(options) : options);
  if (!fit.summary.IsSolutionUsable()) return kInfinity;
  Eigen::VectorXd errors =
      (model.Predict(fit.values, others.joint_values) - others.points)
          .colwise()
          .norm();
  if (!errors.allFinite()) return kInfinity;
  double* const middle = errors.data() + errors.size() / 2;
  std::nth_element(errors.data(), middle, errors.data() + errors.size());
  return *middle;
}

// A cure and the error that it leaves. Cures compare by the part of how far the
// positions then lie apart: a smaller unit makes every error smaller.
struct Cure {
  const InputMistake* mistake = nullptr;
  PositionSample mended;
  double misfit = kInfinity;

  double Relative() const { return misfit / ExtentOf(mended.points); }
};

void KeepBest(std::size_t count, std::vector<Cure>* cures) {
  std::stable_sort(
      cures->begin(), cures->end(),
      [](const Cure& a, const Cure& b) { return a.Relative() < b.Relative(); });
  if (cures->size() > count) cures->resize(count);
}

class Diagnosis {
 public:
  Diagnosis(const Arm& arm, const PositionSample& sample)
      : arm_(arm), sample_(sample) {
    Arm at_origin = arm;
    at_origin.instrument_from_base.setIdentity();
    reach_ = Reach(at_origin);
  }

  InputDiagnosis Run() {
    const double tolerated = Tolerated(sample_, kTolerated, kExplains);
    if (MisfitAsStated(arm_, sample_) <= tolerated) return {};
    const double misfit = Misfit(arm_, sample_);
    if (!(misfit > tolerated) || !std::isfinite(misfit)) return {};
    solved_ = SolvedMisfit(arm_, sample_);
    if (IsExplained(sample_, solved_)) return {};
    Finding finding{"plausibility.position_misfit", misfit, tolerated, "",
                    FindingLevel::kAttention};
    finding.sentence =
        "the measured positions do not fit this arm wherever its base and "
        "tool are: half of them are more than " +
        FormatLength(misfit, 3) + " off";
    const std::vector<InputMistake> singles = SingleMistakes(arm_);
    std::vector<Cure> cures = FindCures(singles);
    // Two that explain it as well are as possible: a joint that counts the
    // other way may be two others that do.
    std::vector<std::string> found;
    for (const Cure& cure : cures) found.push_back(cure.mistake->text);
    const std::vector<InputMistake> doubles = DoubleMistakes(arm_, found);
    const double best = cures.empty() ? kInfinity : cures.front().Relative();
    for (Cure& cure : FindCures(doubles)) {
      if (cure.Relative() <= kAlike * best) cures.push_back(std::move(cure));
    }
    // A zero that is degrees off, which the calibration itself will find.
    if (cures.empty() &&
        IsExplained(sample_, SolvedMisfit(arm_, sample_, true))) {
      return {};
    }
    finding.sentence += Describe(cures);
    return {finding, !cures.empty()};
  }

 private:
  double Tolerated(const PositionSample& sample, double of_reach,
                   double of_extent) const {
    return std::min(of_reach * reach_, of_extent * ExtentOf(sample.points));
  }

  bool IsExplained(const PositionSample& sample, double solved) const {
    return solved <= Tolerated(sample, kSolvedTolerated, kSolvedExplains);
  }

  // Those that explain the data after a calibration, the best and what is as
  // good. Cheap looks choose which are worth an expensive one.
  std::vector<Cure> FindCures(const std::vector<InputMistake>& mistakes) const {
    std::vector<Cure> cures;
    for (const InputMistake& mistake : mistakes) {
      PositionSample mended = sample_;
      mistake.mend(&mended);
      const double misfit = MisfitAsStated(arm_, mended);
      cures.push_back({&mistake, std::move(mended), misfit});
    }
    KeepBest(kMostFitted, &cures);
    for (Cure& cure : cures) cure.misfit = Misfit(arm_, cure.mended);
    KeepBest(kMostSolved, &cures);
    for (Cure& cure : cures) cure.misfit = SolvedMisfit(arm_, cure.mended);
    KeepBest(kMostSolved, &cures);
    const Cure as_read{nullptr, sample_, solved_};
    const double best = cures.front().Relative();
    std::vector<Cure> explaining;
    for (Cure& cure : cures) {
      if (IsExplained(cure.mended, cure.misfit) &&
          kClearlyBetter * cure.Relative() < as_read.Relative() &&
          cure.Relative() <= kAlike * best) {
        explaining.push_back(std::move(cure));
      }
    }
    return explaining;
  }

  static std::string Describe(const std::vector<Cure>& cures) {
    if (cures.empty()) {
      return ". No single mistake of units, columns or signs explains it, nor "
             "two together: check whether the arm file describes the arm that "
             "was measured";
    }
    const std::string error = FormatLength(cures.front().misfit, 2);
    const std::string how =
        " (calibrated with two thirds of them, the others "
        "are " +
        error + " off)";
    if (cures.size() == 1) {
      return ". They fit" + how + " if " + cures.front().mistake->text;
    }
    constexpr std::size_t kMostNamed = 4;
    std::vector<std::string> texts;
    for (const Cure& cure : cures) {
      if (texts.size() == kMostNamed) {
        texts.emplace_back("others");
        break;
      }
      texts.push_back(cure.mistake->text);
    }
    return ". Several mistakes explain it alike" + how +
           ", since base and tool can imitate one by another; look which is "
           "there: " +
           Join(texts, "; or ");
  }

  const Arm& arm_;
  const PositionSample& sample_;
  double reach_ = 0.0;
  double solved_ = kInfinity;  // as read
};

// The source of the first row for which is_lost(), and how many there are.
template <typename IsLost>
std::int64_t CountLost(const Dataset& data, Communicator* communicator,
                       const IsLost& is_lost, std::string* first) {
  std::int64_t count = 0;
  for (const ObservationBlock& block : data.blocks) {
    if (!HoldsPosition(block.kind)) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const auto sigmas = block.sigmas.col(i).head<3>();
      if (!sigmas.allFinite() || !is_lost(block.measured.col(i).head<3>())) {
        continue;
      }
      if (++count == 1) *first = SourceOf(data, block.pose(i));
    }
  }
  return SumOverRanks(communicator, data, count);
}

Eigen::Vector3d MedianPoint(const PositionSample& sample) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::VectorXd values = sample.points.row(axis);
    double* const middle = values.data() + values.size() / 2;
    std::nth_element(values.data(), middle, values.data() + values.size());
    median[axis] = *middle;
  }
  return median;
}

// A few positions that no arm of this size can reach from the others.
std::optional<Finding> DiagnoseFar(const Arm& arm, const Dataset& data,
                                   const PositionSample& sample,
                                   Communicator* communicator) {
  constexpr double kFar = 8.0;      // of the reach
  constexpr double kFewPart = 0.2;  // of the positions
  Arm at_origin = arm;
  at_origin.instrument_from_base.setIdentity();
  const double far = kFar * Reach(at_origin);
  const Eigen::Vector3d median = MedianPoint(sample);
  std::string first;
  const std::int64_t count = CountLost(
      data, communicator,
      [&](const Eigen::Vector3d& point) {
        return !((point - median).norm() <= far);
      },
      &first);
  if (count == 0 || static_cast<double>(count) >
                        kFewPart * static_cast<double>(data.global_poses())) {
    return std::nullopt;
  }
  return Finding{"plausibility.far_positions", static_cast<double>(count), 0.0,
                 (first.empty() ? "" : first + ": ") +
                     Count(count, "position") + (count == 1 ? " is" : " are") +
                     " more than " + FormatLength(far, 2) +
                     " from the others, which no arm of this size reaches: "
                     "instruments write such numbers when they have lost the "
                     "target. Empty these cells or leave the rows out",
                 FindingLevel::kFailed};
}

}  // namespace

InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             Communicator* communicator) {
  const std::optional<PositionSample> sample =
      SamplePositions(data, communicator);
  if (!sample) return {};
  if (auto far = DiagnoseFar(arm, data, *sample, communicator)) {
    return {std::move(far), true};
  }
  return Diagnosis(arm, *sample).Run();
}

std::optional<Finding> DiagnoseZeros(const Dataset& data,
                                     Communicator* communicator) {
  std::string first;
  const std::int64_t count = CountLost(
      data, communicator,
      [](const Eigen::Vector3d& point) { return point.isZero(0.0); }, &first);
  if (count == 0) return std::nullopt;
  return Finding{
      "plausibility.zero_positions", static_cast<double>(count), 0.0,
      (first.empty() ? "" : first + ": ") + std::to_string(count) +
          (count == 1 ? " position is" : " positions are") +
          " exactly 0, 0, 0, which instruments write when they have lost the "
          "target: empty these cells or leave the rows out",
      FindingLevel::kAttention};
}

}  // namespace alidade::internal
