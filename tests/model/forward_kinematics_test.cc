#include "alidade/forward_kinematics.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/random_datasets.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::forward_kinematics_test {
namespace {

constexpr int kArmsPerSize = 20;
constexpr int kPosesPerArm = 10;

// Twelve joints with three plane rotations each: some forty roundings of
// eps / 2 of the reach, and angles of up to 2 pi that are rounded themselves.
constexpr double kTolerance = 1e-14;

Eigen::Vector3d PositionOf(const Arm& arm, const double* joint_values) {
  const ParameterLayout layout(arm.num_joints());
  const Eigen::VectorXd values = layout.Values(arm);
  return TargetPosition(arm, ViewOf(layout, values.data()), joint_values);
}

void ExpectNear(const Eigen::Vector3d& actual, const Eigen::Vector3d& expected,
                double tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(actual[axis], expected[axis], tolerance) << "axis " << axis;
  }
}

TEST(TargetPositionTest, PublishedFlangePosition) {
  const Arm arm = testing::Rv2ajFlange();
  std::array<double, 5> joint_values = {-107.756, 32.1796, 104.1809, 42.9295,
                                        66.1123};
  for (double& value : joint_values) value *= kDegree;
  // Half a unit of the last printed digit.
  ExpectNear(PositionOf(arm, joint_values.data()) / kMillimetre,
             {-74.55, -232.81, 323.81}, 0.005);
}

TEST(TargetPositionTest, ZeroIsTheArmStraightUp) {
  const std::array<double, 5> zero = {};
  // 300 + 250 + 160 mm, and the flange's 72 mm; the cosine of 90 deg is
  // 6e-17.
  ExpectNear(PositionOf(testing::Rv2ajWrist(), zero.data()), {0.0, 0.0, 0.710},
             2e-16);
  ExpectNear(PositionOf(testing::Rv2ajFlange(), zero.data()), {0.0, 0.0, 0.782},
             2e-16);
}

TEST(TargetPositionTest, PostureWorkedOutByHand) {
  // The shoulder leans the stretched arm (410 mm) to the horizontal, the waist
  // turns it to y; the elbow then folds the forearm (160 mm) down.
  const Arm arm = testing::Rv2ajWrist();
  const double quarter = 90.0 * kDegree;
  const std::array<double, 5> stretched = {quarter, quarter, 0.0, 0.0, 0.0};
  ExpectNear(PositionOf(arm, stretched.data()), {0.0, 0.410, 0.300}, 4e-16);
  const std::array<double, 5> folded = {quarter, quarter, quarter, 0.0, 0.0};
  ExpectNear(PositionOf(arm, folded.data()), {0.0, 0.250, 0.140}, 4e-16);
}

TEST(TargetPositionTest, RevoluteTurnsAndPrismaticTravels) {
  Arm arm;
  arm.joints.resize(1);
  arm.joints[0].theta = 0.2;
  arm.joints[0].r = 0.5;
  arm.last_from_target().translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  const double q = 0.3;
  ExpectNear(PositionOf(arm, &q), {std::cos(0.5), std::sin(0.5), 0.5}, 3e-16);
  arm.joints[0].type = JointType::kPrismatic;
  ExpectNear(PositionOf(arm, &q), {std::cos(0.2), std::sin(0.2), 0.8}, 3e-16);
}

class RandomArmTest : public ::testing::TestWithParam<int> {};

TEST_P(RandomArmTest, AgreesWithMatrixProducts) {
  Random random(101, GetParam());
  for (int i = 0; i < kArmsPerSize; ++i) {
    const Arm arm = testing::RandomArm(GetParam(), &random);
    const Eigen::MatrixXd poses =
        testing::RandomJointValues(arm, kPosesPerArm, &random);
    for (Eigen::Index pose = 0; pose < poses.cols(); ++pose) {
      const double* joint_values = poses.col(pose).data();
      ExpectNear(PositionOf(arm, joint_values),
                 testing::MatrixPosition(arm, joint_values).cast<double>(),
                 kTolerance * Reach(arm));
    }
  }
}

TEST_P(RandomArmTest, LongDoubleAgreesWithMatrixProductsAndWithDouble) {
  Random random(102, GetParam());
  const ParameterLayout layout(GetParam());
  for (int i = 0; i < kArmsPerSize; ++i) {
    const Arm arm = testing::RandomArm(GetParam(), &random);
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
    const testing::VectorXl values = testing::MatrixValues(arm);
    const testing::Vector3l position =
        TargetPosition(arm, ViewOf(layout, values.data()), pose.data());
    // Eleven bits more than double: the same bound, 2048 times tighter.
    const testing::Vector3l error =
        position - testing::MatrixPosition(arm, pose.data());
    EXPECT_LE(error.norm(), kTolerance / 2048.0 * Reach(arm));
    ExpectNear(PositionOf(arm, pose.data()), position.cast<double>(),
               kTolerance * Reach(arm));
  }
}

TEST_P(RandomArmTest, BaseAndToolFollowTheirValues) {
  Random random(103, GetParam());
  const ParameterLayout layout(GetParam());
  for (const double length : testing::RotationLengths()) {
    const Arm arm = testing::RandomArm(GetParam(), &random);
    Eigen::VectorXd values = testing::ValuesWithRotations(arm, length, &random);
    for (const ParameterKind kind :
         {ParameterKind::kBaseTranslation, ParameterKind::kToolTranslation}) {
      values.segment<3>(layout.Column(kind, 0)) +=
          testing::RandomVector(0.1, &random);
    }
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
    ExpectNear(
        TargetPosition(arm, ViewOf(layout, std::as_const(values).data()),
                       pose.data()),
        testing::MatrixPosition(arm, values.cast<long double>(), pose.data())
            .cast<double>(),
        kTolerance * (Reach(arm) + 0.2));
  }
}

TEST_P(RandomArmTest, WithoutBaseAndToolBlocksTheArmsOwnAreUsed) {
  Random random(104, GetParam());
  const ParameterLayout layout(GetParam());
  const Arm arm = testing::RandomArm(GetParam(), &random);
  const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
  const Eigen::VectorXd values = layout.Values(arm);
  GeometryView<double> geometry = ViewOf(layout, values.data());
  geometry.base = nullptr;
  geometry.tool = nullptr;
  EXPECT_EQ(TargetPosition(arm, geometry, pose.data()),
            PositionOf(arm, pose.data()));
}

TEST_P(RandomArmTest, ReachBoundsTheDistance) {
  Random random(105, GetParam());
  for (int i = 0; i < kArmsPerSize; ++i) {
    const Arm arm = testing::RandomArm(GetParam(), &random);
    const Eigen::MatrixXd pose = testing::RandomJointValues(arm, 1, &random);
    EXPECT_LE(PositionOf(arm, pose.data()).norm(),
              Reach(arm) * (1.0 + kTolerance));
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, RandomArmTest, ::testing::Range(1, 13));

TEST(RotatePlaneTest, TurnsTheFirstTowardsTheSecond) {
  double a = 1.0;
  double b = 0.0;
  RotatePlane(1.0, 0.0, &a, &b);
  EXPECT_EQ(a, 0.0);
  EXPECT_EQ(b, 1.0);
}

TEST(ReachTest, AddsAllLengths) {
  // 300 + 250 + 160 + 72 mm.
  EXPECT_DOUBLE_EQ(Reach(testing::Rv2ajFlange()), 0.782);
  Arm arm = testing::Rv2ajFlange();
  arm.joints[1].d = -0.010;
  arm.joints[3].r = -0.020;
  arm.instrument_from_base.translation() = Eigen::Vector3d(0.3, 0.0, -0.4);
  arm.last_from_target().translation() = Eigen::Vector3d(0.0, 0.06, 0.08);
  EXPECT_DOUBLE_EQ(Reach(arm), 0.782 + 0.010 + 0.020 + 0.5 + 0.1);
}

TEST(ReachTest, CountsLimitedTravelOnly) {
  Arm arm;
  arm.joints.resize(1);
  arm.joints[0].r = 0.25;
  arm.joints[0].lower = -0.75;
  arm.joints[0].upper = 0.5;
  EXPECT_DOUBLE_EQ(Reach(arm), 0.25);
  arm.instrument_from_base.translation().z() = 3.0;
  EXPECT_DOUBLE_EQ(Reach(arm), 3.25);
  EXPECT_DOUBLE_EQ(ArmReach(arm), 0.25);
  arm.instrument_from_base.translation().setZero();
  arm.joints[0].type = JointType::kPrismatic;
  EXPECT_DOUBLE_EQ(Reach(arm), 0.25 + 0.75);
  arm.joints[0].upper = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(Reach(arm), 0.25);
}

TEST(ReachTest, OfAnArmWithoutLengthsIsOneMetre) {
  Arm arm;
  arm.joints.resize(2);
  EXPECT_EQ(Reach(arm), 1.0);
}

}  // namespace
}  // namespace alidade::internal::forward_kinematics_test
