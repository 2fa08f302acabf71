#ifndef ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_
#define ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/table.h"

namespace alidade::internal {

/// Accuracy before and after, by stages and by cross-validation, how the
/// residuals compare with the sigmas, and the acceptance limits.
std::string AccuracySection(const CalibrationResult& result);

/// Empty where there are none.
std::string OutlierSection(const CalibrationResult& result);
std::string RejectedRowSection(const CalibrationResult& result);

/// The tables of these, empty where a result has not what they show. Lengths
/// and, in tables of their own, orientations.
Table AccuracyTable(const CalibrationResult& result, Dimension dimension);
Table StagesTable(const CalibrationResult& result, Dimension dimension);
Table OutlierTable(const CalibrationResult& result);
Table RejectedRowTable(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ACCURACY_REPORT_H_
