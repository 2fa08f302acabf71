#ifndef ALIDADE_TESTS_SUPPORT_RANDOM_DATASETS_H_
#define ALIDADE_TESTS_SUPPORT_RANDOM_DATASETS_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal::testing {

/// Lengths of rotation vectors (rad) at which formulas change their character:
/// none, tiny, on both sides of where the series of Exp and of its derivative
/// end (1e-6, 1e-2), of the order of one, and near a half turn.
std::vector<double> RotationLengths();

/// The values of `arm` with small rotations of base and tools that are
/// `rotation_length` long (rad), each about an axis of its own.
Eigen::VectorXd ValuesWithRotations(const Arm& arm, double rotation_length,
                                    Random* random);

/// Positions that `arm` with `values` takes by the independent kinematics,
/// rounded to double, at random joint values; every sigma is its own.
Dataset RandomDataset(const Arm& arm, const Eigen::VectorXd& values,
                      int num_poses, Random* random);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_RANDOM_DATASETS_H_
