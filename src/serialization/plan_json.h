#ifndef ALIDADE_SRC_SERIALIZATION_PLAN_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_PLAN_JSON_H_

#include <string>

#include "alidade/plan.h"

namespace alidade::internal {

/// plan.json (docs/files.md).
std::string FormatPlanJson(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PLAN_JSON_H_
