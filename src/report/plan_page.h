#ifndef ALIDADE_SRC_REPORT_PLAN_PAGE_H_
#define ALIDADE_SRC_REPORT_PLAN_PAGE_H_

#include <string>

#include "alidade/plan.h"
#include "src/report/arm_view.h"

namespace alidade::internal {

/// plan.html: what the plan promises, its poses and what they determine. Tables
/// hold at most 1000 rows. `plan_json` is in the page, which saves it, unless
/// it is longer than 500 kB. `shapes`: of the arm's links, where they are
/// known.
std::string RenderPlanPage(const PlanResult& result,
                           const std::string& plan_json, ArmShapes shapes = {});

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_PLAN_PAGE_H_
