#include "src/job/posture_search.h"

#include <gtest/gtest.h>

#include "alidade/arm_file.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/job/arm_branch.h"

namespace alidade::internal {
namespace {

Arm LoadRobot(const std::string& name) {
  return LoadArm(std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/" + name +
                 ".yaml");
}

Eigen::VectorXd Degrees(std::initializer_list<double> values) {
  Eigen::VectorXd joints(static_cast<Eigen::Index>(values.size()));
  Eigen::Index j = 0;
  for (const double value : values) joints[j++] = value * kDegree;
  return joints;
}

TEST(FollowStraightWayTest, ArrivesWhereNoJointTurnsFast) {
  const Arm arm = LoadRobot("kr6_r900_sixx");
  const Eigen::VectorXd from = Degrees({10, -60, 90, 20, 40, 10});
  const Eigen::VectorXd to = Degrees({20, -70, 95, 10, 50, 5});
  const StraightWay way = FollowStraightWay(arm, from, TargetPose(arm, to), {});
  EXPECT_EQ(way.status, PoseStatus::kReached);
  EXPECT_EQ(way.fraction, 1.0);
  EXPECT_LT((way.joint_values - to).norm(), 1e-6);
}

TEST(FollowStraightWayTest, StopsAtASingularPoseAndAtALimit) {
  Arm arm = LoadRobot("kr6_r900_sixx");
  // Sideways with a straight wrist, whose axes 4 and 6 then turn at once.
  const Eigen::VectorXd straight = Degrees({0, -90, 90, 0, 0, 0});
  Eigen::Isometry3d beside = TargetPose(arm, straight);
  beside.translation().y() += 0.05;
  const StraightWay turned = FollowStraightWay(arm, straight, beside, {});
  EXPECT_NE(turned.status, PoseStatus::kReached);
  EXPECT_LT(turned.fraction, 0.5);
  // Away from it in its own plane it may go.
  Eigen::Isometry3d below = TargetPose(arm, straight);
  below.translation().z() -= 0.05;
  EXPECT_EQ(FollowStraightWay(arm, straight, below, {}).status,
            PoseStatus::kReached);
  const Eigen::VectorXd from = Degrees({10, -60, 90, 20, 40, 10});
  const Eigen::VectorXd to = Degrees({60, -60, 90, 20, 40, 10});
  arm.joints[0].upper = 30.0 * kDegree;
  const StraightWay limited =
      FollowStraightWay(arm, from, TargetPose(arm, to), {});
  EXPECT_EQ(limited.status, PoseStatus::kLimit);
  EXPECT_GT(limited.fraction, 0.1);
  EXPECT_LT(limited.fraction, 0.9);
}

// Whatever its distance: steps that jump over the place are cut.
TEST(FollowStraightWayTest, StopsBesideASingularPose) {
  const Arm arm = LoadRobot("kr6_r900_sixx");
  const Eigen::VectorXd from = Degrees({0, -60, 90, 0, 20, 0});
  const Eigen::Isometry3d end =
      TargetPose(arm, Degrees({0, -60, 90, 0, -20, 0}));
  EXPECT_EQ(FollowStraightWay(arm, from, end, {}).status, PoseStatus::kReached);
  for (const double beside : {0.05, 0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0}) {
    Eigen::Isometry3d pose = end;
    pose.translation().y() += beside * kMillimetre;
    EXPECT_NE(FollowStraightWay(arm, from, pose, {}).status,
              PoseStatus::kReached)
        << beside;
  }
}

TEST(FindPosturesTest, AllReachThePoseAndTheNearestIsFirst) {
  const Arm arm = LoadRobot("ur10");
  const Eigen::VectorXd joints = Degrees({10, -60, 80, -100, -70, 15});
  const Eigen::Isometry3d pose = TargetPose(arm, joints);
  const auto postures = FindPostures(arm, pose, joints, 1, {});
  // Shoulder, elbow and wrist.
  EXPECT_GE(postures.size(), 8U);
  EXPECT_LT((postures.front() - joints).norm(), 1e-6);
  for (const Eigen::VectorXd& posture : postures) {
    EXPECT_TRUE(TargetPose(arm, posture).isApprox(pose, 1e-7));
  }
}

TEST(ArmBranchTest, IsThatOfRapid) {
  const Arm arm = LoadRobot("irb120");
  EXPECT_EQ(ArmBranch(arm, Degrees({0, 0, 0, 0, 30, 0})), 0);
  EXPECT_EQ(ArmBranch(arm, Degrees({70, 0, 0, 0, -30, 0})), 1);
  // The forearm folded back over the lower arm, which leans forward.
  EXPECT_EQ(ArmBranch(arm, Degrees({0, 80, 150, 0, 30, 0})), 2);
  // The lower arm leans back beyond axis 1.
  EXPECT_EQ(ArmBranch(arm, Degrees({0, -100, 0, 0, 30, 0})), 4);
  // Of a UR the axes of the wrist do not meet.
  EXPECT_FALSE(ArmBranch(LoadRobot("ur10"), Degrees({0, 0, 0, 0, 30, 0})));
}

}  // namespace
}  // namespace alidade::internal
