#ifndef ALIDADE_SRC_REPORT_PLAN_TABLES_H_
#define ALIDADE_SRC_REPORT_PLAN_TABLES_H_

#include <string>
#include <vector>

#include "alidade/plan.h"
#include "src/report/svg_chart.h"
#include "src/report/table.h"

namespace alidade::internal {

// What plan.txt and plan.html both have. PlanResult::evaluations holds the
// plan, the greedy one and random poses, in this order.

/// How many poses of what, to find what.
std::string PlanOpening(const PlanResult& result);
/// How far from the best the plan can be, and its travel.
std::string PlanQuality(const PlanResult& result);
/// Which links may be in each other's way, and what that is worth; nothing
/// where it was not looked at.
std::string LinkCautionText(const PlanResult& result);

Table PlanEvaluationTable(const PlanResult& result);
Table PlanCurveTable(const PlanResult& result);
Table PlannedParameterTable(const PlanResult& result);
Table PlannedTermTable(const PlanResult& result);
Table PlannedPoseTable(const PlanResult& result);
/// How much of its range each joint uses.
Table JointCoverageTable(const PlanResult& result);

/// Predicted accuracy by the number of poses: hue planned or random, dashes
/// worst or rms. @pre there is a curve.
LineChart PlanCurveChart(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PLAN_TABLES_H_
