#ifndef ALIDADE_SRC_REPORT_BUDGET_REPORT_H_
#define ALIDADE_SRC_REPORT_BUDGET_REPORT_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/page.h"
#include "src/report/report.h"

namespace alidade::internal {

// The uncertainty budget, and pose accuracy and repeatability by ISO 9283; each
// is left out where the result has none.

std::string BudgetText(const CalibrationResult& result);
PageSection BudgetSection(const CalibrationResult& result);
/// budget.csv and iso9283.csv.
std::vector<ReportFile> MakeBudgetFiles(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_BUDGET_REPORT_H_
