#include "tests/support/random_datasets.h"

namespace alidade::internal::testing {

std::vector<double> RotationLengths() {
  return {0.0, 1e-12, 1e-8, 9e-7, 1.1e-6, 9.9e-3, 1.01e-2, 1.0, kPi - 1e-6};
}

Eigen::VectorXd ValuesWithRotations(const Arm& arm, double rotation_length,
                                    Random* random) {
  const ParameterLayout layout(arm);
  Eigen::VectorXd values = layout.Values(arm);
  values.segment<3>(layout.Column(ParameterKind::kBaseRotation, 0)) =
      rotation_length * RandomDirection(random);
  for (int target = 0; target < arm.num_targets(); ++target) {
    values.segment<3>(layout.Column(ParameterKind::kToolRotation, 0, target)) =
        rotation_length * RandomDirection(random);
  }
  return values;
}

Dataset RandomDataset(const Arm& arm, const Eigen::VectorXd& values,
                      int num_poses, Random* random) {
  Dataset data;
  data.name = "random";
  data.joint_values = RandomJointValues(arm, num_poses, random);
  Eigen::MatrixXd positions(3, num_poses);
  Eigen::MatrixXd sigmas(3, num_poses);
  const VectorXl exact_values = values.cast<long double>();
  for (int i = 0; i < num_poses; ++i) {
    positions.col(i) =
        MatrixPosition(arm, exact_values, data.joint_values.col(i).data())
            .cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      sigmas(axis, i) = random->Uniform(1e-5, 1e-3);
    }
  }
  data.positions() = std::move(positions);
  data.sigmas() = std::move(sigmas);
  return data;
}

}  // namespace alidade::internal::testing
