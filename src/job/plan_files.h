#ifndef ALIDADE_SRC_JOB_PLAN_FILES_H_
#define ALIDADE_SRC_JOB_PLAN_FILES_H_

#include <string>
#include <vector>

#include "alidade/plan.h"
#include "src/report/report.h"
#include "src/serialization/plan_config.h"

namespace alidade::internal {

/// PlanPoses, and where the result comes from. @throws InputError.
PlanResult RunPlan(const PlanConfig& config, const std::string& command);

/// poses.csv, plan.txt, accuracy.svg, curve.csv and, last, plan.json.
std::vector<ReportFile> RenderPlan(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PLAN_FILES_H_
