#ifndef ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_
#define ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_

#include "src/serialization/job_context.h"
#include "src/serialization/plan_config.h"

namespace alidade::internal {

/// The plan's `candidates`: how they are drawn or read, and their constraints.
/// @throws InputError.
void ReadPlanCandidates(JobContext* context, PlanConfig* plan);

/// The plan's `region`. @throws InputError.
void ReadPlanRegion(const JobContext& context, PlanConfig* plan);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PLAN_CANDIDATES_H_
