#ifndef ALIDADE_SRC_REPORT_PLAN_REPORT_H_
#define ALIDADE_SRC_REPORT_PLAN_REPORT_H_

#include <string>
#include <vector>

#include "alidade/plan.h"
#include "src/report/report.h"

namespace alidade::internal {

/// What `plan` prints: the predicted accuracy of the plan beside greedy and
/// random poses, and accuracy by the number of poses. Lengths in mm.
std::string FormatPlanSummary(const PlanResult& result);

/// The whole plan.txt: the summary, parameters, and the poses in their order.
std::string FormatPlan(const PlanResult& result);

/// accuracy.svg (predicted accuracy by the number of poses, with its bound) and
/// curve.csv, where there is a curve.
std::vector<ReportFile> MakePlanFiles(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PLAN_REPORT_H_
