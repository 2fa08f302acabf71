#ifndef ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_
#define ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_

#include <Eigen/Core>

#include "alidade/arm.h"
#include "alidade/parameter_layout.h"
#include "alidade/references.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_context.h"

namespace alidade::internal {

/// The points and planes of the job's `references`. @throws InputError.
References ReadReferences(const JobContext& context);

/// Appends the distances of the job's `references` to its data. @pre the job's
/// references are those of all its data. @throws InputError.
void ReadPointDistances(const JobContext& context, double default_sigma,
                        JobConfig* job);

/// The layout of an arm measured against references.
ParameterLayout LayoutOf(const Arm& arm, const References& references);

/// Values of the nominal arm and of the references, one per column of their
/// layout.
Eigen::VectorXd NominalValues(const Arm& arm, const References& references);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_REFERENCES_SECTION_H_
