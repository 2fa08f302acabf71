#include "alidade/measurement/geometric_jacobian.h"

#include <gtest/gtest.h>

#include "alidade/base/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade {
namespace {

// The rotation vector that turns `from` into `to`, of first order: the skew
// part of to from^T.
Eigen::Vector3d SmallTurn(const testing::Matrix4l& from,
                          const testing::Matrix4l& to) {
  const Eigen::Matrix<long double, 3, 3> turn =
      to.topLeftCorner<3, 3>() * from.topLeftCorner<3, 3>().transpose();
  return 0.5 * Eigen::Vector3d(static_cast<double>(turn(2, 1) - turn(1, 2)),
                               static_cast<double>(turn(0, 2) - turn(2, 0)),
                               static_cast<double>(turn(1, 0) - turn(0, 1)));
}

TEST(GeometricJacobianTest, PoseRowsAreTheDerivativesOfMatrixProducts) {
  Random random(7);
  for (int n = 1; n <= 8; ++n) {
    testing::RandomArmOptions options;
    options.num_targets = 2;
    const Arm arm = testing::RandomArm(n, &random, options);
    const ParameterLayout layout(arm);
    Eigen::VectorXd values = layout.Values(arm);
    // Rotation vectors away from zero too.
    values[layout.Column(ParameterKind::kBaseRotation, 1)] = 0.7;
    values[layout.Column(ParameterKind::kToolRotation, 0)] = -0.4;
    values[layout.Column(ParameterKind::kToolRotation, 2, 1)] = 0.9;
    const Eigen::MatrixXd q = testing::RandomJointValues(arm, 1, &random);
    const int target = n % 2;
    GeometricJacobian jacobian(arm, layout, values);
    jacobian.MoveTo(q.data(), target);
    // Central differences in extended precision: the error is h^2 / 6, 2e-13.
    constexpr long double kStep = 1e-6L;
    for (int c = 0; c < layout.size(); ++c) {
      testing::VectorXl above = values.cast<long double>();
      testing::VectorXl below = above;
      above[c] += kStep;
      below[c] -= kStep;
      const testing::Matrix4l to =
          testing::MatrixTargetFrame(arm, above, q.data(), target);
      const testing::Matrix4l from =
          testing::MatrixTargetFrame(arm, below, q.data(), target);
      const Eigen::Vector3d turn =
          SmallTurn(from, to) / static_cast<double>(2.0L * kStep);
      const Eigen::Vector3d move =
          ((to - from).topRightCorner<3, 1>() / (2.0L * kStep)).cast<double>();
      EXPECT_NEAR((jacobian.PositionDerivative(c) - move).norm(), 0.0, 1e-10)
          << layout.parameter(c).name << " of " << n;
      EXPECT_NEAR((jacobian.RotationDerivative(c) - turn).norm(), 0.0, 1e-10)
          << layout.parameter(c).name << " of " << n;
    }
  }
}

}  // namespace
}  // namespace alidade
