#include "src/model/chain_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

// The derivative that chain_axes.h states for a parameter of a joint.
Eigen::Vector3d StatedDerivative(const ChainAxes& axes, ParameterKind kind,
                                 int j) {
  const Eigen::Vector3d target = axes.instrument_from_target.translation();
  const Eigen::Vector3d from_before = target - axes.origin_before.col(j);
  const Eigen::Vector3d from_axis = target - axes.origin_on_axis.col(j);
  switch (kind) {
    case ParameterKind::kBeta:
      return axes.beta_axis.col(j).cross(from_before);
    case ParameterKind::kAlpha:
      return axes.alpha_axis.col(j).cross(from_before);
    case ParameterKind::kD:
      return axes.alpha_axis.col(j);
    case ParameterKind::kTheta:
      return axes.joint_axis.col(j).cross(from_axis);
    default:
      return axes.joint_axis.col(j);
  }
}

class ChainAxesTest : public ::testing::TestWithParam<int> {};

TEST_P(ChainAxesTest, DerivativesAreThoseOfTheMatrixProducts) {
  Random random(401, GetParam());
  const ParameterLayout layout(GetParam());
  for (int i = 0; i < 5; ++i) {
    const Arm arm = testing::RandomArm(GetParam(), &random);
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
    const testing::Matrix3Xl expected =
        testing::MatrixJacobian(arm, testing::MatrixValues(arm), pose.data());
    ChainAxes axes;
    ComputeChainAxes(arm, pose.data(), &axes);
    for (const Parameter& parameter : layout.parameters()) {
      if (!ParameterLayout::IsJointKind(parameter.kind)) continue;
      const int column = layout.Column(parameter.kind, parameter.index);
      const Eigen::Vector3d error =
          StatedDerivative(axes, parameter.kind, parameter.index) -
          expected.col(column).cast<double>();
      // Rounding of up to forty products, in units of the lever (angles) or
      // of the axis (lengths); the differences are good to 1e-14 as well.
      EXPECT_LT(error.norm(), 5e-14 * (1.0 + Reach(arm))) << parameter.name;
    }
  }
}

TEST_P(ChainAxesTest, FramesAreThoseOfTheMatrixProducts) {
  Random random(402, GetParam());
  const Arm arm = testing::RandomArm(GetParam(), &random);
  const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
  ChainAxes axes;
  ComputeChainAxes(arm, pose.data(), &axes);
  const Eigen::Matrix4d expected =
      testing::MatrixTargetFrame(arm, pose.data()).cast<double>();
  const Eigen::Matrix4d error = axes.instrument_from_target.matrix() - expected;
  // As above; entries are of order one (rotation) and of the reach.
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-14 * (1.0 + Reach(arm)));
  const Eigen::Matrix4d target =
      (axes.instrument_from_last * arm.last_from_target()).matrix();
  EXPECT_EQ(axes.instrument_from_target.matrix(), target);
}

INSTANTIATE_TEST_SUITE_P(Joints, ChainAxesTest,
                         ::testing::Values(1, 2, 3, 5, 7, 9, 12));

TEST(ChainAxesFixedTest, StraightUpAxesAreThoseOfTheDrawing) {
  const Arm arm = testing::Rv2ajFlange();
  const std::array<double, 5> zero = {};
  ChainAxes axes;
  ComputeChainAxes(arm, zero.data(), &axes);
  // Waist and hand roll about the vertical; shoulder, elbow and wrist about
  // +y (Rot(x, -90 deg) takes z there).
  Eigen::Matrix3Xd joint_axis(3, 5);
  joint_axis << 0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 1, 0, 0, 0, 1;
  Eigen::Matrix3Xd origin_on_axis(3, 5);
  origin_on_axis << 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.300, 0.550, 0.710, 0.710;
  Eigen::Matrix3Xd origin_before(3, 5);
  origin_before << 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.300, 0.300, 0.550, 0.710;
  // Sines and cosines of 90 deg are exact to 6e-17.
  constexpr double kTolerance = 5e-16;
  EXPECT_TRUE(axes.joint_axis.isApprox(joint_axis, kTolerance));
  EXPECT_TRUE(axes.origin_on_axis.isApprox(origin_on_axis, kTolerance));
  EXPECT_TRUE(axes.origin_before.isApprox(origin_before, kTolerance));
  EXPECT_TRUE(axes.instrument_from_last.translation().isApprox(
      Eigen::Vector3d(0.0, 0.0, 0.782), kTolerance));
}

TEST(ChainAxesFixedTest, AxesMayBeReusedForAnotherArm) {
  Random random(403);
  ChainAxes reused;
  for (const int n : {6, 2, 4}) {
    const Arm arm = testing::RandomArm(n, &random);
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
    ChainAxes fresh;
    ComputeChainAxes(arm, pose.data(), &fresh);
    ComputeChainAxes(arm, pose.data(), &reused);
    EXPECT_EQ(reused.beta_axis, fresh.beta_axis);
    EXPECT_EQ(reused.alpha_axis, fresh.alpha_axis);
    EXPECT_EQ(reused.joint_axis, fresh.joint_axis);
    EXPECT_EQ(reused.origin_before, fresh.origin_before);
    EXPECT_EQ(reused.origin_on_axis, fresh.origin_on_axis);
    EXPECT_EQ(reused.instrument_from_target.matrix(),
              fresh.instrument_from_target.matrix());
  }
}

}  // namespace
}  // namespace alidade::internal
