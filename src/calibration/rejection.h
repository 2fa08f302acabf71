#ifndef ALIDADE_SRC_CALIBRATION_REJECTION_H_
#define ALIDADE_SRC_CALIBRATION_REJECTION_H_

#include <string>

#include "src/calibration/fit_report.h"

namespace alidade::internal {

/// Why a finished fit is no success and its arm must not be used, with what to
/// do about it; empty where it may be used. One of:
///
///   - the solver was stopped before it converged, and its residuals are not
///     those of the measurement, or the error is larger than before;
///   - the error grew at training or validation poses by more than chance
///     and their uncertainty (IsWorse);
///   - it is no smaller than at nominal, base and tool fitted, and yet a
///     hundred times what the sigmas say;
///   - half of the errors are more than 2 % of the arm's reach;
///   - there are fewer equations than free parameters, and no priors.
///
/// `result` has its accuracy, runs and reduced chi-square.
std::string ReasonToReject(const CalibrationSolution& fit, bool frames_fitted,
                           const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_REJECTION_H_
