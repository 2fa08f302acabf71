#include "alidade/arm.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "src/model/motors.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

Joint WithLimits(JointType type, double lower, double upper) {
  Joint joint;
  joint.type = type;
  joint.lower = lower;
  joint.upper = upper;
  return joint;
}

TEST(HasLimitsTest, BothSidesMustMeanSomething) {
  const auto has = [](JointType type, double lower, double upper) {
    return HasLimits(WithLimits(type, lower, upper));
  };
  EXPECT_TRUE(has(JointType::kRevolute, -1.0, 2.0));
  EXPECT_TRUE(has(JointType::kPrismatic, -1.0, 2.0));
  EXPECT_FALSE(has(JointType::kRevolute, -1.0, kInfinity));
  EXPECT_FALSE(has(JointType::kRevolute, -kInfinity, 1.0));
  EXPECT_FALSE(has(JointType::kPrismatic, 0.0, 0.0));
}

// Twenty turns are 125.7 rad, wherever they begin.
TEST(HasLimitsTest, OfARevoluteJointTwentyTurnsAreTheMost) {
  const auto has = [](JointType type, double lower, double upper) {
    return HasLimits(WithLimits(type, lower, upper));
  };
  EXPECT_TRUE(has(JointType::kRevolute, -62.0, 62.0));
  EXPECT_FALSE(has(JointType::kRevolute, -63.0, 63.0));
  EXPECT_TRUE(has(JointType::kRevolute, 100.0, 225.0));
  EXPECT_FALSE(has(JointType::kRevolute, -1000.0, 100.0));
  EXPECT_TRUE(has(JointType::kPrismatic, -63.0, 63.0));
}

TEST(ReachTest, IsTheSumOfLengthsAndOneWithoutAny) {
  Arm arm;
  arm.joints.resize(3);
  EXPECT_EQ(ArmReach(arm), 1.0);
  EXPECT_EQ(Reach(arm), 1.0);
  arm.joints[0].d = -0.5;
  arm.joints[1].r = 0.25;
  // Travels count as far as they go, angles do not.
  arm.joints[1].lower = -7.0;
  arm.joints[1].upper = 7.0;
  arm.joints[2] = WithLimits(JointType::kPrismatic, -2.0, 1.0);
  arm.last_from_target().translation() = Eigen::Vector3d(0.0, 3.0, 4.0);
  arm.targets.push_back({"near", Eigen::Isometry3d::Identity()});
  EXPECT_EQ(ArmReach(arm), 7.75);
  arm.instrument_from_base.translation() = Eigen::Vector3d(6.0, 0.0, 8.0);
  EXPECT_EQ(Reach(arm), 17.75);
  EXPECT_EQ(ArmReach(arm), 7.75);
}

// A turn, a slide and a turn, of which the third follows the first.
Arm ArmOfTwoMotors() {
  Arm arm;
  arm.name = "coupled";
  arm.joints.resize(3);
  arm.joints[0].d = 0.5;
  arm.joints[1].type = JointType::kPrismatic;
  arm.joints_from_motors.resize(3, 2);
  arm.joints_from_motors << 2.0, 0.0,  //
      0.0, 4.0,                        //
      -1.0, 0.0;
  arm.motor_offsets = Eigen::Vector3d(0.5, 0.25, -0.25);
  return arm;
}

TEST(MotorMapTest, JointsAreTheMapAndTheOffsets) {
  const Arm arm = ArmOfTwoMotors();
  Eigen::MatrixXd motors(2, 2);
  motors << 1.0, 0.0, 0.5, 0.0;
  Eigen::MatrixXd expected(3, 2);
  expected << 2.5, 0.5, 2.25, 0.25, -1.25, -0.25;
  EXPECT_EQ(JointsFromMotors(arm, motors), expected);
  EXPECT_TRUE(MotorsFromJoints(arm, expected).isApprox(motors, 1e-15));
  EXPECT_TRUE(HasMotorMap(arm));
  EXPECT_TRUE(HasFewerMotors(arm));
  EXPECT_EQ(NumMotors(arm), 2);
  EXPECT_THROW(RequireFreeJoints(arm), InputError);
}

// The smallest map, and each part of one without the other.
TEST(MotorMapTest, OneMotorMayCountBackwardsOrHaveAnotherZero) {
  Arm arm;
  arm.joints.resize(1);
  const Eigen::MatrixXd motors = Eigen::MatrixXd::Constant(1, 1, 3.0);
  EXPECT_FALSE(HasMotorMap(arm));
  EXPECT_EQ(JointsFromMotors(arm, motors), motors);
  EXPECT_EQ(MotorsFromJoints(arm, motors), motors);
  arm.joints_from_motors = Eigen::MatrixXd::Constant(1, 1, -2.0);
  EXPECT_TRUE(HasMotorMap(arm));
  EXPECT_EQ(JointsFromMotors(arm, motors)(0, 0), -6.0);
  EXPECT_EQ(MotorsFromJoints(arm, motors)(0, 0), -1.5);
  EXPECT_FALSE(HasFewerMotors(arm));
  EXPECT_NO_THROW(RequireFreeJoints(arm));
  arm.joints_from_motors.resize(0, 0);
  arm.motor_offsets = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_TRUE(HasMotorMap(arm));
  EXPECT_EQ(JointsFromMotors(arm, motors)(0, 0), 3.5);
  EXPECT_EQ(MotorsFromJoints(arm, motors)(0, 0), 2.5);
}

TEST(MotorMapTest, AMotorHasTheUnitOfTheFirstJointThatItMoves) {
  Arm arm = ArmOfTwoMotors();
  const std::vector<Dimension> of_joints = {
      Dimension::kAngle, Dimension::kLength, Dimension::kAngle};
  EXPECT_EQ(MotorDimensions(arm),
            (std::vector<Dimension>{Dimension::kAngle, Dimension::kLength}));
  // The second moves the last joint alone, and not by one.
  arm.joints_from_motors.col(1) = Eigen::Vector3d(0.0, 0.0, 5.0);
  EXPECT_EQ(MotorDimensions(arm),
            (std::vector<Dimension>{Dimension::kAngle, Dimension::kAngle}));
  arm.joints_from_motors.col(0) = Eigen::Vector3d(0.0, 1.0, 0.0);
  EXPECT_EQ(MotorDimensions(arm),
            (std::vector<Dimension>{Dimension::kLength, Dimension::kAngle}));
  arm.joints_from_motors.resize(0, 0);
  EXPECT_EQ(MotorDimensions(arm), of_joints);
  EXPECT_EQ(NumMotors(arm), 3);
}

TEST(DrawJointValuesTest, AreWithinLimitsOrATurnOrTheReach) {
  Arm arm = ArmOfTwoMotors();
  arm.joints_from_motors.resize(0, 0);
  arm.motor_offsets.resize(0);
  arm.joints[2].lower = 4.0;
  arm.joints[2].upper = 5.0;
  const Eigen::MatrixXd drawn = DrawJointValues(arm, 400, 7);
  const Eigen::Vector3d lowest(-kPi, -0.5, 4.0);
  const Eigen::Vector3d highest(kPi, 0.5, 5.0);
  for (int j = 0; j < 3; ++j) {
    // Of 400 even draws none is in the outer fiftieth once in 3000 times.
    const double margin = 0.02 * (highest[j] - lowest[j]);
    EXPECT_GE(drawn.row(j).minCoeff(), lowest[j]);
    EXPECT_LE(drawn.row(j).minCoeff(), lowest[j] + margin);
    EXPECT_LE(drawn.row(j).maxCoeff(), highest[j]);
    EXPECT_GE(drawn.row(j).maxCoeff(), highest[j] - margin);
  }
  // Each configuration has its own engine.
  EXPECT_EQ(DrawJointValues(arm, 1, 7), drawn.leftCols(1));
  Random first(7, 0);
  EXPECT_EQ(drawn(0, 0), DrawJointValue(arm, 0, &first));
}

TEST(DrawJointValuesTest, AreThoseThatMotorsCanReach) {
  const Arm arm = ArmOfTwoMotors();
  const Eigen::MatrixXd drawn = DrawJointValues(arm, 20, 7);
  // The third joint follows the first: q3 + 0.25 = -(q1 - 0.5) / 2.
  EXPECT_LT((drawn.row(2).array() + 0.25 + 0.5 * (drawn.row(0).array() - 0.5))
                .abs()
                .maxCoeff(),
            1e-14);
  EXPECT_GT(drawn.row(0).maxCoeff() - drawn.row(0).minCoeff(), 1.0);
}

TEST(TargetPositionsTest, AreThoseOfTheMatrixProducts) {
  Random random(310);
  testing::RandomArmOptions options;
  options.num_targets = 2;
  const Arm arm = testing::RandomArm(6, &random, options);
  const Eigen::MatrixXd poses = testing::RandomJointValues(arm, 5, &random);
  for (const int target : {0, 1}) {
    const Eigen::Matrix3Xd positions = TargetPositions(arm, poses, target);
    for (int i = 0; i < 5; ++i) {
      const Eigen::Matrix4d expected =
          testing::MatrixTargetFrame(arm, testing::MatrixValues(arm),
                                     poses.col(i).data(), target)
              .cast<double>();
      // As in forward_kinematics_test.cc: some units of eps of the reach.
      EXPECT_LT((positions.col(i) - expected.topRightCorner<3, 1>()).norm(),
                1e-14 * (1.0 + Reach(arm)));
    }
  }
}

}  // namespace
}  // namespace alidade::internal
