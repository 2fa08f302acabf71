#ifndef ALIDADE_SRC_CALIBRATION_FIT_WARNINGS_H_
#define ALIDADE_SRC_CALIBRATION_FIT_WARNINGS_H_

#include <string>

#include "alidade/calibration_result.h"
#include "src/calibration/fit_report.h"

namespace alidade::internal {

/// How the fit came about, as far as warnings depend on it.
struct FitHistory {
  bool frames_fitted = false;
  /// Sigma was to be estimated, and too few measurements bound it only.
  bool sigma_is_bound = false;
  /// EstimatedSigmas::has_two_groups.
  bool has_two_groups = false;
  /// Something was said against the input already.
  bool input_was_suspect = false;
};

/// Adds a warning to the result, and to the log.
void AddWarning(const std::string& warning, CalibrationResult* result);
/// The same of a finding about the input, which the result also keeps as such.
void AddWarning(const Finding& finding, CalibrationResult* result);

/// Adds what speaks against a result although a solver calls it usable: a
/// minimum may be a bad one, of wrong data, of a wrong arm, or not reached at
/// all. `result` has its runs, training accuracy, outliers and reduced
/// chi-square.
void WarnOfFit(const CalibrationSolution& fit, const FitHistory& history,
               CalibrationResult* result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FIT_WARNINGS_H_
