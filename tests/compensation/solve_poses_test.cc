// Inverse kinematics of arms with error terms, against 4 x 4 products in
// extended precision.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/compensation/chain_evaluator.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/random_arms.h"

namespace alidade::internal {
namespace {

using testing::ErrorTermKinematics;
using testing::WithRandomErrors;

// The promise of `correct`: 1e-6 mm and 1e-7 rad.
constexpr double kPosition = 1e-9;
constexpr double kRotation = 1e-7;

struct Remaining {
  double position;
  double rotation;
  double axis;
};

Remaining RemainingOf(const ErrorTermKinematics& oracle,
                      const Eigen::Isometry3d& target,
                      const Eigen::VectorXd& joint_values) {
  const Eigen::Matrix4d found = oracle.TargetFrame(joint_values).cast<double>();
  const Eigen::Matrix3d turn =
      target.linear() * found.topLeftCorner<3, 3>().transpose();
  const Eigen::Vector3d axis = found.block<3, 1>(0, 2);
  return {(found.topRightCorner<3, 1>() - target.translation()).norm(),
          VectorFromRotation(turn).norm(),
          axis.cross(target.linear().col(2)).norm()};
}

Arm RobotArm(const std::string& name) {
  Arm arm = LoadArm(std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/" +
                    name + ".yaml");
  for (Joint& joint : arm.joints) {
    if (HasLimits(joint)) continue;
    joint.upper = joint.type == JointType::kRevolute ? 2.5 : 0.4;
    joint.lower = -joint.upper;
  }
  arm.last_from_target().translation() += Eigen::Vector3d(0.02, -0.01, 0.08);
  return arm;
}

// Within the limits by a margin larger than what a calibration moves.
Eigen::MatrixXd Draw(const Arm& arm, int count, Random* random) {
  Eigen::MatrixXd joint_values(arm.num_joints(), count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Joint& joint = arm.joints[j];
      const double margin = 0.03 * (joint.upper - joint.lower);
      joint_values(j, i) =
          random->Uniform(joint.lower + margin, joint.upper - margin);
    }
  }
  return joint_values;
}

std::vector<Eigen::Isometry3d> PosesOf(const Arm& arm,
                                       const Eigen::MatrixXd& joint_values) {
  std::vector<Eigen::Isometry3d> poses;
  for (const auto& q : joint_values.colwise()) {
    poses.push_back(TargetPose(arm, q));
  }
  return poses;
}

TEST(ChainEvaluatorTest, PosesAreThoseOfTheEquations) {
  Random random(801);
  for (int i = 0; i < 20; ++i) {
    const Arm arm = WithRandomErrors(testing::RandomArm(6, &random), &random);
    const ErrorTermKinematics oracle(arm);
    ChainEvaluator chain(arm, 0);
    ChainState state;
    state.jacobian.resize(6, 6);
    const Eigen::VectorXd q = testing::RandomJointValues(arm, 1, &random);
    chain.Evaluate(q.data(), &state);
    const Eigen::Matrix4d expected = oracle.TargetFrame(q).cast<double>();
    // Rounding of some hundred operations on values of size 1 to 3.
    EXPECT_LT((state.position - expected.topRightCorner<3, 1>()).norm(), 1e-14);
    const Eigen::Matrix3d rotation = expected.topLeftCorner<3, 3>();
    EXPECT_LT((state.rotation - rotation).norm(), 1e-14);
    // The library's one definition of the model gives the same.
    EXPECT_LT((TargetPose(arm, q).matrix() - expected).norm(), 1e-14);
  }
}

TEST(ChainEvaluatorTest, TheJacobianIsTheSlopeOfThePose) {
  Random random(802);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 20; ++i) {
    const Arm arm = WithRandomErrors(testing::RandomArm(6, &random), &random);
    const ErrorTermKinematics oracle(arm);
    ChainEvaluator chain(arm, 0);
    ChainState state;
    state.jacobian.resize(6, 6);
    const Eigen::VectorXd q = testing::RandomJointValues(arm, 1, &random);
    chain.Evaluate(q.data(), &state);
    for (int j = 0; j < 6; ++j) {
      Eigen::VectorXd ahead = q;
      Eigen::VectorXd behind = q;
      ahead[j] += kStep;
      behind[j] -= kStep;
      const testing::Matrix4l to = oracle.TargetFrame(ahead);
      const testing::Matrix4l from = oracle.TargetFrame(behind);
      Eigen::Matrix<double, 6, 1> slope;
      slope.head<3>() =
          ((to - from).topRightCorner<3, 1>() / (2.0 * kStep)).cast<double>();
      const Eigen::Matrix3d turn =
          (to.topLeftCorner<3, 3>() * from.topLeftCorner<3, 3>().transpose())
              .cast<double>();
      slope.tail<3>() = VectorFromRotation(turn) / (2.0 * kStep);
      // What the moments' own change brings is left out: compliances of 2e-5
      // and moments that change by some 100 N m per rad.
      EXPECT_LT((state.jacobian.col(j) - slope).norm(), 0.01);
    }
  }
}

// Large ones, so that each shows.
TEST(ChainEvaluatorTest, TheJacobianHasSlopesAndCoupling) {
  Random random(812);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 20; ++i) {
    Arm arm = testing::RandomArm(6, &random);
    arm.errors.coupling = Eigen::MatrixXd::Random(6, 6) * 0.1;
    for (const Joint& joint : arm.joints) {
      JointErrors errors;
      errors.function.first = -4.0;
      errors.function.spacing = 0.5;
      errors.function.values = Eigen::VectorXd::Random(17) * 0.1;
      if (joint.type == JointType::kRevolute) {
        errors.harmonics = {{3.0, 0.05, -0.02}};
      }
      arm.errors.joints.push_back(errors);
    }
    const ErrorTermKinematics oracle(arm);
    ChainEvaluator chain(arm, 0);
    ChainState state;
    state.jacobian.resize(6, 6);
    const Eigen::VectorXd q = testing::RandomJointValues(arm, 1, &random);
    chain.Evaluate(q.data(), &state);
    for (int j = 0; j < 6; ++j) {
      Eigen::VectorXd ahead = q;
      Eigen::VectorXd behind = q;
      ahead[j] += kStep;
      behind[j] -= kStep;
      const Eigen::Vector3d slope =
          ((oracle.TargetFrame(ahead) - oracle.TargetFrame(behind))
               .topRightCorner<3, 1>() /
           (2.0 * kStep))
              .cast<double>();
      // No knot is within a step of these joint values.
      EXPECT_LT((state.jacobian.col(j).head<3>() - slope).norm(), 1e-9);
    }
  }
}

class SolvePosesTest : public ::testing::TestWithParam<const char*> {};

TEST_P(SolvePosesTest, TheRealArmReachesWhatTheNominalOneWasAskedFor) {
  Random random(803);
  const Arm nominal = RobotArm(GetParam());
  const Arm real = WithRandomErrors(nominal, &random);
  const ErrorTermKinematics oracle(real);
  const Eigen::MatrixXd starts = Draw(nominal, 1000, &random);
  const auto targets = PosesOf(nominal, starts);
  const PoseSolutions found = SolvePoses(real, targets, starts);
  int num_reached = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto left =
        RemainingOf(oracle, targets[i], found.joint_values.col(i));
    EXPECT_NEAR(left.position, found.position_error[i], 1e-12);
    EXPECT_NEAR(left.rotation, found.rotation_error[i], 1e-12);
    if (found.status[i] != PoseStatus::kReached) continue;
    ++num_reached;
    EXPECT_LT(left.position, kPosition) << i;
    if (nominal.num_joints() > 5) {
      EXPECT_LT(left.rotation, kRotation) << i;
    }
    const Eigen::VectorXd change = found.joint_values.col(i) - starts.col(i);
    EXPECT_LE(change.cwiseAbs().maxCoeff(), 0.5 * ArmReach(nominal));
  }
  // Near singular poses a joint moves far or the target is out of reach.
  EXPECT_GE(num_reached, 960);
}

TEST_P(SolvePosesTest, WhatTheRealArmCanDoIsReachedWithItsOrientation) {
  Random random(804);
  const Arm nominal = RobotArm(GetParam());
  const Arm real = WithRandomErrors(nominal, &random);
  const ErrorTermKinematics oracle(real);
  const Eigen::MatrixXd truth = Draw(nominal, 200, &random);
  Eigen::MatrixXd starts = truth;
  for (double& value : starts.reshaped()) value += random.Uniform(-0.01, 0.01);
  const auto targets = PosesOf(real, truth);
  const PoseSolutions found = SolvePoses(real, targets, starts);
  int num_reached = 0;
  for (int i = 0; i < 200; ++i) {
    if (found.status[i] != PoseStatus::kReached) continue;
    const auto left =
        RemainingOf(oracle, targets[i], found.joint_values.col(i));
    num_reached += left.position < kPosition && left.rotation < kRotation;
  }
  EXPECT_GE(num_reached, 190);
}

INSTANTIATE_TEST_SUITE_P(Robots, SolvePosesTest,
                         ::testing::Values("rv2aj_flange", "ur10", "irb120",
                                           "panda", "lifting_column"));

TEST(SolvePosesTest, RedundantJointsStayNearestToTheirStart) {
  Random random(805);
  const Arm arm = WithRandomErrors(RobotArm("panda"), &random);
  const Eigen::MatrixXd truth = Draw(arm, 50, &random);
  Eigen::MatrixXd starts = truth;
  for (double& value : starts.reshaped()) value += random.Uniform(-0.02, 0.02);
  const auto targets = PosesOf(arm, truth);
  const PoseSolutions found = SolvePoses(arm, targets, starts);
  ChainEvaluator chain(arm, 0);
  ChainState state;
  state.jacobian.resize(6, 7);
  for (int i = 0; i < 50; ++i) {
    if (found.status[i] != PoseStatus::kReached) continue;
    // The direction that leaves the pose as it is is at right angles to what
    // the joints have moved.
    chain.Evaluate(found.joint_values.col(i).eval().data(), &state);
    const Eigen::MatrixXd jacobian = state.jacobian;
    const Eigen::VectorXd idle =
        jacobian.jacobiSvd(Eigen::ComputeFullV).matrixV().col(6);
    const Eigen::VectorXd moved = found.joint_values.col(i) - starts.col(i);
    EXPECT_LT(std::abs(idle.dot(moved)), 1e-6) << i;
    EXPECT_GT(moved.norm(), 1e-4);
  }
}

TEST(SolvePosesTest, ALimitThatKeepsTheTargetAwayIsReported) {
  Random random(806);
  Arm arm = RobotArm("irb120");
  Eigen::VectorXd q(6);
  q << 0.3, 0.2, 0.1, 0.4, 0.8, -0.3;
  const auto targets = PosesOf(arm, q);
  arm.joints[1].upper = 0.19;
  Eigen::VectorXd start = q;
  start[1] = 0.15;
  const PoseSolutions found = SolvePoses(arm, targets, start);
  EXPECT_EQ(found.status[0], PoseStatus::kLimit);
  EXPECT_TRUE(IsWithinLimits(arm, found.joint_values.col(0)));
  EXPECT_GT(found.position_error[0], 1e-4);
  // The other joints of a redundant arm take over.
  Arm panda = RobotArm("panda");
  Eigen::VectorXd posture(7);
  posture << 0.1, 0.4, -0.2, -1.5, 0.3, 1.6, 0.5;
  const auto reachable = PosesOf(panda, posture);
  panda.joints[0].upper = 0.09;
  posture[0] = 0.07;
  const PoseSolutions other = SolvePoses(panda, reachable, posture);
  EXPECT_EQ(other.status[0], PoseStatus::kReached);
  EXPECT_TRUE(IsWithinLimits(panda, other.joint_values.col(0)));
}

TEST(SolvePosesTest, OutOfReachHasADampedAnswer) {
  const Arm arm = RobotArm("ur10");
  Eigen::VectorXd start(6);
  start << 0.2, -0.5, 1.0, -0.6, 1.2, 0.0;
  auto targets = PosesOf(arm, start);
  targets[0].translation() *= 1.5 / targets[0].translation().norm();
  const PoseSolutions found = SolvePoses(arm, targets, start);
  EXPECT_EQ(found.status[0], PoseStatus::kOutOfReach);
  EXPECT_TRUE(found.joint_values.allFinite());
  // No farther from it than the start.
  EXPECT_LT(
      found.position_error[0],
      (targets[0].translation() - TargetPose(arm, start).translation()).norm());
}

TEST(SolvePosesTest, AnotherPostureIsABranchChange) {
  const Arm arm = RobotArm("irb120");
  Eigen::VectorXd q(6);
  q << 0.3, 0.2, 0.1, 0.4, 0.04, -0.3;
  const auto targets = PosesOf(arm, q);
  // The wrist the other way round, from which Newton's method gets there.
  Eigen::VectorXd start = q;
  start[4] = -0.04;
  PoseSolverOptions options;
  const PoseSolutions found = SolvePoses(arm, targets, start, options);
  EXPECT_NE(found.status[0], PoseStatus::kReached);
}

TEST(SolvePosesTest, ThreadsDoNotChangeTheBits) {
  Random random(807);
  const Arm nominal = RobotArm("ur10");
  const Arm real = WithRandomErrors(nominal, &random);
  const Eigen::MatrixXd starts = Draw(nominal, 2000, &random);
  const auto targets = PosesOf(nominal, starts);
  PoseSolverOptions options;
  const PoseSolutions one = SolvePoses(real, targets, starts, options);
  options.num_threads = 3;
  const PoseSolutions three = SolvePoses(real, targets, starts, options);
  EXPECT_EQ(one.joint_values, three.joint_values);
  EXPECT_EQ(one.status, three.status);
}

TEST(FindPosesTest, FindsAPostureFromTheMiddle) {
  Random random(808);
  for (const char* robot : {"irb120", "panda", "rv2aj_flange"}) {
    const Arm arm = RobotArm(robot);
    const Eigen::MatrixXd truth = Draw(arm, 50, &random);
    const auto targets = PosesOf(arm, truth);
    const PoseSolutions found =
        FindPoses(arm, targets, MiddleOfLimits(arm), 200, 1);
    int num_reached = 0;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Isometry3d pose =
          TargetPose(arm, found.joint_values.col(i).eval());
      num_reached +=
          found.status[i] == PoseStatus::kReached &&
          (pose.translation() - targets[i].translation()).norm() < kPosition;
    }
    EXPECT_EQ(num_reached, 50) << robot;
  }
}

}  // namespace
}  // namespace alidade::internal
