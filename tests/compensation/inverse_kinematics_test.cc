#include "alidade/inverse_kinematics.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>

#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

// Tolerances of the default options, and the rounding of the check itself.
constexpr double kReached = 1.001e-9;

// Where the arm points at `joint_values`, by the independent kinematics.
PointingTask TaskAt(const Arm& arm, const Eigen::VectorXd& joint_values) {
  Arm bare = arm;
  bare.last_from_target() = Eigen::Isometry3d::Identity();
  const testing::Matrix4l last =
      testing::MatrixTargetFrame(bare, joint_values.data());
  PointingTask task;
  task.position =
      testing::MatrixPosition(arm, joint_values.data()).cast<double>();
  task.direction = last.block<3, 1>(0, 2).cast<double>().normalized();
  return task;
}

void ExpectFulfils(const Arm& arm, const PointingTask& task,
                   const Eigen::VectorXd& joint_values) {
  const PointingTask reached = TaskAt(arm, joint_values);
  EXPECT_LT((reached.position - task.position).norm(), kReached);
  if (task.direction) {
    EXPECT_LT((*reached.direction - *task.direction).norm(), kReached);
  }
  EXPECT_TRUE(IsWithinLimits(arm, joint_values));
}

Eigen::VectorXd Degrees(const std::array<double, 5>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), 5) * kDegree;
}

// Elbow bent forwards and hand down: the posture of the study's poses.
Eigen::VectorXd BentStart() { return Degrees({0.0, 40.0, 80.0, 40.0, 0.0}); }

// Joint values near the middle of the workspace, away from its border and from
// limits: waist within 20 deg of the start's, the elbow well bent.
Eigen::VectorXd RandomPosture(Random* random) {
  const auto near = [&](double middle_deg) {
    return middle_deg + random->Uniform(-20.0, 20.0);
  };
  const double waist = near(0.0);
  const double shoulder = near(40.0);
  const double elbow = near(80.0);
  const double wrist = near(40.0);
  return Degrees({waist, shoulder, elbow, wrist, near(0.0)});
}

TEST(InverseKinematicsTest, ReachesRandomTargetsWithDirection) {
  Random random(701);
  for (Arm arm : {testing::Rv2ajWrist(), testing::Rv2ajFlange(),
                  testing::WithRv2ajDeviations(testing::Rv2ajFlange())}) {
    arm.instrument_from_base = testing::RandomFrame(1.0, &random);
    for (int i = 0; i < 100; ++i) {
      const PointingTask task = TaskAt(arm, RandomPosture(&random));
      const auto found = SolveInverseKinematics(arm, task, BentStart());
      ASSERT_TRUE(found.has_value()) << arm.name << ", target " << i;
      ExpectFulfils(arm, task, *found);
    }
  }
}

TEST(InverseKinematicsTest, ReachesPositionsWithATool) {
  Random random(702);
  Arm arm = testing::Rv2ajFlange();
  arm.last_from_target().translation() = Eigen::Vector3d(0.02, -0.03, 0.05);
  for (int i = 0; i < 100; ++i) {
    PointingTask task = TaskAt(arm, RandomPosture(&random));
    task.direction.reset();
    const auto found = SolveInverseKinematics(arm, task, BentStart());
    ASSERT_TRUE(found.has_value()) << "target " << i;
    ExpectFulfils(arm, task, *found);
  }
}

TEST(InverseKinematicsTest, ReachesTheStudysPlaneAllAround) {
  const Arm arm = testing::Rv2ajWrist();
  for (const double azimuth_deg : {-140.0, -60.0, 20.0, 100.0, 140.0}) {
    for (const double radius : {0.210, 0.300, 0.400}) {
      const double azimuth = azimuth_deg * kDegree;
      const double elevation = -70.0 * kDegree;
      PointingTask task;
      task.position = {radius * std::cos(azimuth), radius * std::sin(azimuth),
                       0.215};
      task.direction = {std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth),
                        std::sin(elevation)};
      Eigen::VectorXd start = BentStart();
      start[0] = azimuth;
      const auto found = SolveInverseKinematics(arm, task, start);
      ASSERT_TRUE(found.has_value()) << azimuth_deg << " deg, " << radius;
      ExpectFulfils(arm, task, *found);
      EXPECT_NEAR((*found)[0], azimuth, 1e-8);
    }
  }
}

TEST(InverseKinematicsTest, AStartThatFulfilsTheTaskIsReturnedAsItIs) {
  const Arm arm = testing::Rv2ajFlange();
  const Eigen::VectorXd start = BentStart();
  const auto found = SolveInverseKinematics(arm, TaskAt(arm, start), start);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(*found, start);
}

TEST(InverseKinematicsTest, AFreeLastJointKeepsItsStart) {
  Random random(703);
  const Arm arm = testing::Rv2ajFlange();
  for (const double roll_deg : {0.0, 30.0, -170.0}) {
    PointingTask task = TaskAt(arm, RandomPosture(&random));
    Eigen::VectorXd start = BentStart();
    start[4] = roll_deg * kDegree;
    const auto found = SolveInverseKinematics(arm, task, start);
    ASSERT_TRUE(found.has_value());
    // The target is on the last axis up to rounding, which the damping (at
    // least 1e-12) lets through as steps of at most 1e-11 rad.
    EXPECT_NEAR((*found)[4], start[4], 1e-9);
    EXPECT_GT((*found - start).norm(), 1e-3);
  }
}

TEST(InverseKinematicsTest, TheStartChoosesThePosture) {
  // Wrist centre, position only: elbow up and elbow down reach alike.
  Arm arm = testing::Rv2ajWrist();
  PointingTask task = TaskAt(arm, Degrees({0.0, 30.0, 60.0, 0.0, 0.0}));
  task.direction.reset();
  const auto forwards =
      SolveInverseKinematics(arm, task, Degrees({0.0, 20.0, 70.0, 0.0, 0.0}));
  const auto backwards =
      SolveInverseKinematics(arm, task, Degrees({0.0, 60.0, -50.0, 0.0, 0.0}));
  ASSERT_TRUE(forwards.has_value());
  ASSERT_TRUE(backwards.has_value());
  EXPECT_NEAR((*forwards)[2], 60.0 * kDegree, 1e-6);
  EXPECT_NEAR((*backwards)[2], -60.0 * kDegree, 1e-6);
}

TEST(InverseKinematicsTest, OutOfReachIsNothing) {
  const Arm arm = testing::Rv2ajFlange();
  PointingTask task;
  // The stretched arm ends 482 mm from the shoulder at a height of 300 mm.
  for (const double radius : {0.4821, 0.6, 5.0}) {
    task.position = {radius, 0.0, 0.300};
    EXPECT_FALSE(SolveInverseKinematics(arm, task, BentStart()).has_value())
        << radius;
  }
}

TEST(InverseKinematicsTest, AnUnreachableDirectionIsNothing) {
  // Five joints: the hand cannot leave the vertical plane through the waist.
  const Arm arm = testing::Rv2ajFlange();
  PointingTask task = TaskAt(arm, BentStart());
  task.direction = Eigen::Vector3d::UnitY();
  EXPECT_FALSE(SolveInverseKinematics(arm, task, BentStart()).has_value());
}

TEST(InverseKinematicsTest, OutsideTheLimitsIsNothing) {
  Arm arm = testing::Rv2ajWrist();
  const Eigen::VectorXd posture = Degrees({30.0, 30.0, 70.0, 30.0, 0.0});
  const PointingTask task = TaskAt(arm, posture);
  ASSERT_TRUE(SolveInverseKinematics(arm, task, BentStart()).has_value());
  arm.joints[0].upper = 29.9 * kDegree;
  EXPECT_FALSE(SolveInverseKinematics(arm, task, BentStart()).has_value());
  arm.joints[0].upper = 30.1 * kDegree;
  EXPECT_TRUE(SolveInverseKinematics(arm, task, BentStart()).has_value());
}

TEST(InverseKinematicsTest, APrismaticArmTravels) {
  // A gantry: z of the last frame along x, then y, then z of the base.
  Arm arm;
  arm.joints.resize(3);
  for (Joint& joint : arm.joints) {
    joint.type = JointType::kPrismatic;
    joint.lower = -1.0;
    joint.upper = 1.0;
  }
  arm.joints[0].beta = 90.0 * kDegree;
  arm.joints[1].alpha = 90.0 * kDegree;
  arm.joints[2].beta = 90.0 * kDegree;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  PointingTask task;
  task.position = {0.3, -0.4, 0.8};
  const auto found = SolveInverseKinematics(arm, task, zero);
  ASSERT_TRUE(found.has_value());
  ExpectFulfils(arm, task, *found);
  task.position = {0.3, -0.4, 1.2};
  EXPECT_FALSE(SolveInverseKinematics(arm, task, zero).has_value());
}

TEST(InverseKinematicsTest, MixedJointsReachWhatTheyReachedBefore) {
  Random random(704);
  int num_found = 0;
  for (int i = 0; i < 50; ++i) {
    const Arm arm = testing::RandomArm(6, &random);
    const Eigen::VectorXd posture = testing::RandomJointValues(arm, 1, &random);
    const Eigen::VectorXd start =
        posture + 0.05 * testing::RandomJointValues(arm, 1, &random);
    PointingTask task = TaskAt(arm, posture);
    task.direction.reset();
    const auto found = SolveInverseKinematics(arm, task, start);
    if (!found) continue;
    ++num_found;
    ExpectFulfils(arm, task, *found);
  }
  // Some postures lie at a limit, and some are singular.
  EXPECT_GE(num_found, 40);
}

TEST(InverseKinematicsTest, TooFewIterationsAreNothing) {
  const Arm arm = testing::Rv2ajFlange();
  const PointingTask task = TaskAt(arm, Degrees({60.0, 20.0, 90.0, 30.0, 0.0}));
  InverseKinematicsOptions options;
  EXPECT_TRUE(SolveInverseKinematics(arm, task, BentStart(), options));
  options.max_iterations = 2;
  EXPECT_FALSE(SolveInverseKinematics(arm, task, BentStart(), options));
}

TEST(InverseKinematicsTest, TolerancesDecideWhatIsReached) {
  const Arm arm = testing::Rv2ajFlange();
  const Eigen::VectorXd start = BentStart();
  PointingTask task = TaskAt(arm, start);
  task.position.x() += 0.5e-3;
  InverseKinematicsOptions loose;
  loose.position_tolerance = 1e-3;
  EXPECT_EQ(SolveInverseKinematics(arm, task, start, loose), start);
  const auto exact = SolveInverseKinematics(arm, task, start);
  ASSERT_TRUE(exact.has_value());
  EXPECT_NE(*exact, start);
}

TEST(IsWithinLimitsTest, TakesTheLimitsThemselves) {
  Arm arm;
  arm.joints.resize(2);
  arm.joints[0].lower = -1.0;
  arm.joints[0].upper = 2.0;
  EXPECT_TRUE(IsWithinLimits(arm, Eigen::Vector2d(-1.0, 1e9)));
  EXPECT_TRUE(IsWithinLimits(arm, Eigen::Vector2d(2.0, -1e9)));
  EXPECT_FALSE(IsWithinLimits(arm, Eigen::Vector2d(2.001, 0.0)));
  EXPECT_FALSE(IsWithinLimits(arm, Eigen::Vector2d(-1.001, 0.0)));
  EXPECT_FALSE(IsWithinLimits(arm, Eigen::Vector2d(std::nan(""), 0.0)));
}

}  // namespace
}  // namespace alidade::internal
