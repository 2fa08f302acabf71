#ifndef ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/identifiability.h"
#include "alidade/parameter_layout.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_context.h"

namespace alidade::internal {

/// The job's `identifiability`; parameters are named as in the layout.
/// @throws InputError.
void ReadIdentifiability(const JobContext& context,
                         const ParameterLayout& layout,
                         IdentifiabilityOptions* options);

/// The job's `bounds`, absolute; `nominal` has one value per column of the
/// layout. @throws InputError.
std::vector<ParameterBounds> ReadBounds(const JobContext& context,
                                        const ParameterLayout& layout,
                                        const Eigen::VectorXd& nominal);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_IDENTIFIABILITY_SECTION_H_
