#ifndef ALIDADE_SRC_JOB_CORRECTION_COLUMNS_H_
#define ALIDADE_SRC_JOB_CORRECTION_COLUMNS_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/correction.h"

namespace alidade::internal {

/// One of so many targets, to be filled.
Correction EmptyCorrection(Eigen::Index count, int num_joints);

/// Makes the only target of `one` target i of `all`.
void PutCorrection(const Correction& one, Eigen::Index i, Correction* all);

/// Those targets alone of which `is_kept`.
Correction KeptCorrections(const Correction& all,
                           const std::vector<bool>& is_kept);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_CORRECTION_COLUMNS_H_
