#ifndef ALIDADE_TESTS_SUPPORT_NOISY_POSITIONS_H_
#define ALIDADE_TESTS_SUPPORT_NOISY_POSITIONS_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/dataset.h"
#include "src/common/random.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/kernel/measurement_model.h"
#include "src/model/joint_draw.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::testing {

/// Positions of an arm as it is at poses drawn within its limits, with Gaussian
/// noise of `sigma` on every coordinate, from products of matrices.
Dataset NoisyPositions(const Arm& arm, int num_poses, double sigma,
                       std::uint64_t seed);

/// What generic poses can distinguish, without priors.
std::vector<int> TellableColumns(const MeasurementModel& model,
                                 const Dataset& data);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_NOISY_POSITIONS_H_
