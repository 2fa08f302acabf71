#ifndef ALIDADE_SRC_JOB_PLAN_FILES_H_
#define ALIDADE_SRC_JOB_PLAN_FILES_H_

#include <vector>

#include "src/planning/plan.h"
#include "src/report/report.h"

namespace alidade::internal {

/// poses.csv, plan.txt, accuracy.svg, curve.csv and, last, plan.json.
std::vector<ReportFile> RenderPlan(const PlanOutcome& outcome);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PLAN_FILES_H_
