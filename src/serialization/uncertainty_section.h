#ifndef ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_SECTION_H_

#include "src/serialization/job_config.h"
#include "src/serialization/job_context.h"

namespace alidade::internal {

/// The job's `uncertainty`: how far results are to be trusted, and how that is
/// told. @throws InputError.
void ReadUncertaintyOptions(const JobContext& context, JobConfig* job);

/// The job's `montecarlo`. @throws InputError, also where the data cannot be
/// simulated or `truth` asks for what the job does not have.
void ReadMonteCarlo(const JobContext& context, JobConfig* job);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_UNCERTAINTY_SECTION_H_
