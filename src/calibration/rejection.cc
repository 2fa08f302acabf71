#include "src/calibration/rejection.h"

#include <algorithm>
#include <cmath>

#include "src/calibration/improvement.h"
#include "src/calibration/preparation.h"
#include "src/common/format.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr double kLargeRatio = 2.0;

// Standardised residuals; of a robust fit those of a typical observation.
double ResidualRatio(const CalibrationSolution& fit,
                     const CalibrationResult& result) {
  return fit.task.options.loss == LossKind::kNone
             ? std::sqrt(result.reduced_chi_square)
             : TypicalResidual(fit.model(), fit.task.data.training, fit.values);
}

// Its positions fitted nowhere, and no mistake of input explained them: then
// the fit has to, or the arm is not the one that was measured.
bool IsOfAnotherArm(const CalibrationResult& result) {
  return std::any_of(result.plausibility.begin(), result.plausibility.end(),
                     [](const Finding& finding) {
                       return finding.key == "plausibility.position_misfit";
                     });
}

bool IsUseless(const CalibrationSolution& fit, bool frames_fitted,
               const CalibrationResult& result) {
  constexpr double kNoBetter = 0.9;
  constexpr double kTimesSigma = 100.0;
  constexpr double kOfReach = 0.02;
  constexpr double kOfReachOfMisfit = 0.005;
  const bool is_robust = fit.task.options.loss != LossKind::kNone;
  const Accuracy& before = result.train.before;
  const Accuracy& after = result.train.after;
  const bool is_better = is_robust ? after.median < kNoBetter * before.median
                                   : after.rms < kNoBetter * before.rms;
  // With sigma estimated no residual is large in sigmas, but it may be of a
  // size that no calibrated arm is off by.
  const double left = after.median / ArmReach(fit.task.arm);
  return (frames_fitted && !is_better &&
          ResidualRatio(fit, result) > kTimesSigma) ||
         left > kOfReach ||
         (IsOfAnotherArm(result) && left > kOfReachOfMisfit &&
          (fit.task.options.estimate_sigma ||
           ResidualRatio(fit, result) > kLargeRatio));
}

// Along directions that hardly matter a solver may creep for ever and be right.
bool IsStoppedAway(const CalibrationSolution& fit,
                   const CalibrationResult& result) {
  constexpr double kLargeResiduals = 2.5;
  const KeptErrors judged = JudgedSet(result).Judged();
  return result.runs.front().summary.status == SolverStatus::kIterationLimit &&
         (ResidualRatio(fit, result) > kLargeResiduals ||
          judged.after.rms > judged.before.rms);
}

bool IsUndetermined(const CalibrationSolution& fit) {
  return fit.problem.priors.size() == 0 &&
         GlobalEquations(fit.model().communicator(), fit.problem.data) <
             static_cast<Eigen::Index>(fit.problem.free_columns.size());
}

std::string GrowsAt(const char* poses, const KeptErrors& set) {
  return std::string("the mean error at the ") + poses + " poses grows from " +
         FormatLength(set.before.mean, 3) + " to " +
         FormatLength(set.after.mean, 3) +
         ", by more than chance: look for what is wrong with the data or the "
         "arm, or identify fewer parameters";
}

}  // namespace

std::string ReasonToReject(const CalibrationSolution& fit, bool frames_fitted,
                           const CalibrationResult& result) {
  if (IsUndetermined(fit)) {
    return "there are fewer equations than free parameters and no priors: "
           "measure more poses, identify fewer parameters, or use `policy: "
           "prior`";
  }
  if (IsStoppedAway(fit, result)) {
    return "the solver was stopped by the number of iterations before it "
           "converged: the data do not determine this many parameters, or do "
           "not fit this arm. Identify fewer, measure more poses, look for "
           "what is wrong with the data, or allow more iterations";
  }
  const KeptErrors train = result.train.Judged();
  if (std::isfinite(train.change_t) && IsWorse(train, result)) {
    return GrowsAt("training", train);
  }
  if (result.validation) {
    const KeptErrors validation = result.validation->Judged();
    if (std::isfinite(validation.change_t) && IsWorse(validation, result)) {
      return GrowsAt("validation", validation);
    }
  }
  if (IsUseless(fit, frames_fitted, result)) {
    const double ratio = ResidualRatio(fit, result);
    // Sigmas that were estimated say so themselves.
    const std::string beyond_sigma =
        ratio > kLargeRatio
            ? ", and the residuals are " + FormatSignificant(ratio, 3) +
                  " times as large as the sigmas say"
            : "";
    return "the data do not fit this arm: half of the errors that are left "
           "are more than " +
           FormatLength(result.train.after.median, 3) + beyond_sigma +
           ": look for wrong units, columns, limits, or a wrong arm";
  }
  return "";
}

}  // namespace alidade::internal
