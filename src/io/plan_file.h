#ifndef ALIDADE_SRC_IO_PLAN_FILE_H_
#define ALIDADE_SRC_IO_PLAN_FILE_H_

#include "alidade/io/plan_config.h"
#include "src/io/job_context.h"

namespace alidade {

/// The plan's `candidates`: how they are drawn or read, and their constraints.
/// @throws InputError.
void ReadPlanCandidates(JobContext* context, PlanConfig* plan);

/// The plan's `region`. @throws InputError.
void ReadPlanRegion(const JobContext& context, PlanConfig* plan);

}  // namespace alidade

#endif  // ALIDADE_SRC_IO_PLAN_FILE_H_
