#ifndef ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_

#include <string>
#include <vector>

#include "src/serialization/data_section.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_context.h"

namespace alidade::internal {

/// The job's `validation`: reads other data, or takes poses out of the job's;
/// `sets` are those of its poses (LoadedData). @throws InputError.
void ReadValidation(const MeasurementSigmas& sigmas,
                    const std::vector<std::string>& sets, JobContext* context,
                    JobConfig* job);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_VALIDATION_SECTION_H_
