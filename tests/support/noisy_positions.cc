#include "tests/support/noisy_positions.h"

namespace alidade::internal::testing {

Dataset NoisyPositions(const Arm& arm, int num_poses, double sigma,
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

std::vector<int> TellableColumns(const MeasurementModel& model,
                                 const Dataset& data) {
  IdentifiabilityOptions options;
  options.policy = WeakPolicy::kFreeze;
  return FreeColumns(AnalyzeIdentifiability(model, data, options));
}

}  // namespace alidade::internal::testing
