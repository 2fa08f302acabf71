#include "src/calibration/fit_warnings.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "src/calibration/outlier_pattern.h"
#include "src/calibration/plausibility.h"
#include "src/calibration/preparation.h"
#include "src/calibration/prior_check.h"
#include "src/calibration/same_data.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/distributions.h"
#include "src/common/format.h"
#include "src/common/text.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Residuals of so many sigmas in the root mean square are no chance: with ten
// degrees of freedom the odds are below 1e-6.
constexpr double kLargeResiduals = 2.5;

// Balls in sockets and contacts with planes whose places are all unknown: an
// arm twice as large would touch points twice as far.
bool LeavesSizeOpen(const CalibrationTask& task) {
  if (!task.options.identifiability.candidates.joints) return false;
  for (std::size_t k = 0; k < task.data.training.blocks.size(); ++k) {
    if (task.data.training.global_observations(k) == 0) continue;
    const MeasurementKind kind = task.data.training.blocks[k].kind;
    if (kind != MeasurementKind::kFixedPoint &&
        kind != MeasurementKind::kPlane) {
      return false;
    }
  }
  const auto is_known = [](const auto& reference) {
    return reference.is_known;
  };
  const References& references = task.data.references;
  return std::count_if(references.points.begin(), references.points.end(),
                       is_known) +
             std::count_if(references.planes.begin(), references.planes.end(),
                           is_known) <
         2;
}

// An outlier far beyond all others spoils the fit of them all, unless a robust
// loss has taken its weight.
std::string WarnOfWorst(const CalibrationResult& result,
                        const std::vector<Outlier>& outliers) {
  constexpr double kFarBeyond = 3.0;
  constexpr double kHardlyCounts = 0.01;
  if (outliers.empty()) return "";
  const Outlier& worst = outliers.front();
  const bool is_validation = &outliers == &result.validation_outliers;
  if (worst.weight < kHardlyCounts) return "";
  if (worst.standardised < kFarBeyond * result.outlier_limit) return "";
  return (worst.label.where.empty() ? "" : worst.label.where + ": ") +
         std::string("the ") + (is_validation ? "validation " : "") +
         "measurement that fits worst is " + FormatLength(worst.error, 3) +
         " off, " + FormatSignificant(worst.standardised, 2) +
         " standard deviations (" + std::to_string(outliers.size()) +
         " are beyond what chance allows): look at it, or leave it out "
         "(`data: {exclude: ...}`)" +
         (is_validation ? "" : ", or choose a `loss`");
}

// At the nominal geometry an arm is millimetres off, not a tenth of its size.
std::string WarnOfFrames(const CalibrationSolution& fit, bool frames_fitted,
                         const CalibrationResult& result) {
  constexpr double kLargePart = 0.05;
  Arm at_origin = fit.model().nominal();
  at_origin.instrument_from_base.setIdentity();
  const Accuracy& before = result.train.before;
  if (before.n == 0 || before.median < kLargePart * Reach(at_origin)) return "";
  return frames_fitted
             ? "base, tool or references were not found: at the nominal "
               "geometry half of the measurements are more than " +
                   FormatLength(before.median, 3) +
                   " off. State a guess of base and tool in the arm file"
             : "half of the measurements are more than " +
                   FormatLength(before.median, 3) +
                   " off before calibration. If base or tool are not known, "
                   "identify them too (`parameters: [joints, base, tool]`)";
}

// Residuals below any noise are those of exact data, whatever their sigmas.
bool IsSigmaFarTooLarge(const CalibrationSolution& fit, double ratio,
                        const CalibrationResult& result) {
  constexpr double kMuchSmaller = 0.1;
  constexpr double kNoNoise = 1e-9;  // m
  constexpr double kUnlikely = 1e-4;
  if (fit.task.options.estimate_sigma || !(ratio < kMuchSmaller) ||
      !(result.train.after.median > kNoNoise)) {
    return false;
  }
  const double freedom = DegreesOfFreedom(fit.problem, fit.values);
  return freedom >= 1.0 && ratio > 0.0 &&
         ChiSquareCdf(ratio * ratio * freedom, freedom) < kUnlikely;
}

// Where the loss expects outliers, they are not held against the fit.
std::string WarnOfResiduals(const CalibrationSolution& fit,
                            const CalibrationResult& result) {
  const CalibrationTask& task = fit.task;
  const double ratio =
      task.options.loss == LossKind::kNone
          ? std::sqrt(result.reduced_chi_square)
          : TypicalResidual(fit.model(), task.data.training, fit.values);
  if (IsSigmaFarTooLarge(fit, ratio, result)) {
    return "the stated sigmas are " + FormatSignificant(1.0 / ratio, 2) +
           " times as large as the residuals: priors weigh that much more "
           "than they should, and intervals are that much too wide. State "
           "sigma in the unit of the file, or `measurement: {sigma: "
           "estimate}`";
  }
  if (!(ratio > kLargeResiduals)) return "";
  return "the residuals are " + FormatSignificant(ratio, 3) +
         " times as large as the sigmas say: look for wrong units, columns, "
         "rotation convention, outliers, sigmas or a wrong arm";
}

std::string WarnOfMeaninglessLimits(const Arm& arm) {
  std::string joints;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    if (HasLimits(joint) || std::isinf(joint.lower) ||
        std::isinf(joint.upper)) {
      continue;
    }
    joints += (joints.empty() ? "" : ", ") + std::to_string(j + 1);
  }
  return joints.empty() ? ""
                        : "the limits of joints " + joints +
                              " are equal or span more than twenty turns: "
                              "they are taken as none";
}

// By a thousandth of a turn or a millimetre and more.
std::string WarnOfLimits(const CalibrationTask& task) {
  constexpr double kBeyond = 2e-3;  // rad, and m for joints that slide
  const Arm& arm = task.arm;
  const Dataset& data = task.data.training;
  std::int64_t count = 0;
  std::vector<bool> is_beyond(static_cast<std::size_t>(arm.num_joints()));
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    bool is_any = false;
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Joint& joint = arm.joints[j];
      const double value = data.joint_values(j, i);
      if (!HasLimits(joint) ||
          (value >= joint.lower - kBeyond && value <= joint.upper + kBeyond)) {
        continue;
      }
      is_beyond[static_cast<std::size_t>(j)] = is_any = true;
    }
    count += is_any ? 1 : 0;
  }
  std::string joints;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_here = is_beyond[static_cast<std::size_t>(j)];
    if (SumOverRanks(task.communicator, data, is_here ? 1 : 0) == 0) continue;
    joints += (joints.empty() ? "" : ", ") + std::to_string(j + 1);
  }
  count = SumOverRanks(task.communicator, data, count);
  if (count == 0) return "";
  return Count(count, "pose") + (count == 1 ? " is" : " are") +
         " outside the limits of joints " + joints +
         ": correct the limits, or look for wrong units, signs or zeros. "
         "Predictions and plans stay within the limits";
}

// So many are no accidents, and of a group nearly as large as the other it is
// not known which is right.
std::string WarnOfManyRejected(const CalibrationSolution& fit,
                               const CalibrationResult& result) {
  constexpr double kMany = 0.2;
  if (!result.train.kept) return "";
  const auto rejected = static_cast<double>(result.train.kept->num_rejected);
  const double part =
      rejected / static_cast<double>(std::max<Eigen::Index>(
                     1, fit.task.data.training.global_observations()));
  if (part < kMany) return "";
  return FixedNumber(100.0 * part, 0) +
         " % of the measurements are rejected as outliers: so many are no "
         "accidents, and the fit is that of the larger group. Look for what "
         "they have in common (residuals.csv): a target or an instrument that "
         "was moved, a region of the workspace";
}

// Found with simulated arms: where sigma comes from the residuals of a robust
// fit, it is the less certain the fewer there are.
std::string WarnOfFewForRobust(const CalibrationSolution& fit) {
  constexpr double kFewPerParameter = 2.5;
  const CalibrationTask& task = fit.task;
  if (task.options.loss == LossKind::kNone || !task.options.estimate_sigma) {
    return "";
  }
  const auto equations = static_cast<double>(
      GlobalEquations(fit.model().communicator(), task.data.training));
  const auto free = static_cast<double>(fit.problem.free_columns.size());
  if (equations >= kFewPerParameter * free) return "";
  return "sigma is estimated with a robust loss from few measurements (" +
         FormatSignificant(equations, 6) + " equations for " +
         FormatSignificant(free, 6) +
         " parameters): intervals hold less often than they say, 95 % ones in "
         "some 90 %. Measure more poses, or state sigma";
}

std::string Listed(const std::string& before, const std::string& names,
                   const std::string& after) {
  return names.empty() ? "" : before + names + after;
}

// What became of an estimate of sigma.
std::string WarnOfEstimate(const FitHistory& history) {
  if (history.sigma_is_bound) {
    return "too few measurements to determine sigma from the residuals: it is "
           "taken as what the nominal geometry leaves, so that parameters stay "
           "near nominal. Measure more poses or state sigma";
  }
  if (history.has_two_groups) {
    return "half of the measurements agree far better among themselves than "
           "with the others, which this loss does not leave out. Use `robust: "
           "{loss: tukey}`, and look for what the others have in common";
  }
  return "";
}

}  // namespace

void AddWarning(const std::string& warning, CalibrationResult* result) {
  result->warnings.push_back(warning);
}

void AddWarning(const Finding& finding, CalibrationResult* result) {
  result->plausibility.push_back(finding);
  AddWarning(finding.sentence, result);
}

namespace {

// Rows that were never measured, and copies.
void WarnOfRows(const CalibrationSolution& fit, CalibrationResult* added) {
  const Dataset& data = fit.task.data.training;
  if (const auto lost = DiagnoseLost(data, fit.task.communicator)) {
    AddWarning(*lost, added);
  }
  if (const auto stale = DiagnoseStale(fit.model(), fit.values, data)) {
    AddWarning(*stale, added);
  }
  for (const Finding& copies : DiagnoseSameData(fit.task)) {
    AddWarning(copies, added);
  }
}

}  // namespace

void WarnOfFit(const CalibrationSolution& fit, const FitHistory& history,
               CalibrationResult* added) {
  const CalibrationResult& result = *added;
  const auto warn = [added](const std::string& text) {
    if (!text.empty()) AddWarning(text, added);
  };
  const SolverSummary& summary = result.runs.front().summary;
  WarnOfRows(fit, added);
  warn(WarnOfMeaninglessLimits(fit.task.arm));
  warn(WarnOfLimits(fit.task));
  if (summary.status == SolverStatus::kIterationLimit) {
    warn("the solver " + summary.solver +
         " was stopped by the number of iterations and may be far from the "
         "minimum: allow more, or identify fewer parameters");
  }
  warn(WarnOfResiduals(fit, result));
  if (!history.input_was_suspect) {
    warn(WarnOfFrames(fit, history.frames_fitted, result));
  }
  warn(WarnOfWorst(result, result.outliers));
  warn(WarnOfWorst(result, result.validation_outliers));
  warn(WarnOfManyRejected(fit, result));
  if (!fit.task.data.training.partition) {
    warn(Listed(
        "rejected observations follow ",
        PatternOf(fit.task.arm, fit.task.data.training, result.outliers),
        fit.terms ? ": the error terms do not describe all of the arm's errors"
                  : ": that is no mistake of measurement but an error of the "
                    "arm; `errors: auto` weighs elasticity and errors of "
                    "gears"));
  }
  warn(WarnOfFewForRobust(fit));
  warn(WarnOfPriors(fit, result.identifiability));
  warn(WarnOfEstimate(history));
  if (!(result.reduced_chi_square > 0.0) &&
      DegreesOfFreedom(fit.problem, fit.values) < 1.0) {
    warn(
        "these poses leave no degree of freedom: small residuals say nothing "
        "of the arm's accuracy. Measure more poses");
  }
  if (LeavesSizeOpen(fit.task)) {
    warn(
        "these contacts leave the size of the arm open, which the priors "
        "alone determine: state a known distance between two points "
        "(`references: "
        "{distances: ...}`), or measure one");
  }
  warn(Listed(
      "further from nominal than the priors allow, in standard deviations: ",
      FarFromPriors(fit),
      "; correct the nominal arm, widen the priors or use another policy"));
  warn(Listed("at a bound: ", AtBounds(fit),
              "; the data ask for values beyond, which the bounds do not "
              "allow"));
}

}  // namespace alidade::internal
