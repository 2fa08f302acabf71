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
inline Dataset NoisyPositions(const Arm& arm, int num_poses, double sigma,
                              std::uint64_t seed) {
  const Eigen::MatrixXd joints = DrawJointValues(arm, num_poses, seed);
  Random random(seed, 1000003);
  Eigen::Matrix3Xd points(3, num_poses);
  for (int i = 0; i < num_poses; ++i) {
    points.col(i) = MatrixPosition(arm, joints.col(i).data()).cast<double>();
    for (double& coordinate : points.col(i)) {
      coordinate += sigma * random.Normal();
    }
  }
  return MakePositions(joints, points,
                       Eigen::Matrix3Xd::Constant(3, num_poses, sigma));
}

/// What generic poses can distinguish, without priors.
inline std::vector<int> TellableColumns(const MeasurementModel& model,
                                        const Dataset& data) {
  IdentifiabilityOptions options;
  options.policy = WeakPolicy::kFreeze;
  return FreeColumns(AnalyzeIdentifiability(model, data, options));
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_NOISY_POSITIONS_H_
