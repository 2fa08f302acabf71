#ifndef ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_
#define ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_

#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Accuracy before and after, by stages and by cross-validation, how the
/// residuals compare with the sigmas, and the acceptance limits.
std::string AccuracySection(const CalibrationResult& result);

/// Empty where there are none.
std::string OutlierTable(const CalibrationResult& result);
std::string RejectedRowTable(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_
