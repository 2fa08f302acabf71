#include "src/planning/candidates.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/planning/travel.h"
#include "tests/support/matrix_kinematics.h"
#include "tests/support/random_arms.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using testing::Rv2ajFlange;

CandidateOptions Options(int count) {
  CandidateOptions options;
  options.count = count;
  options.joint_decimals = 2;
  return options;
}

TEST(DrawCandidatesTest, KeepsLimitsAndDecimals) {
  const Arm arm = Rv2ajFlange();
  const Candidates candidates = DrawCandidates(arm, {}, Options(2000));
  ASSERT_EQ(candidates.joint_values.cols(), 2000);
  EXPECT_EQ(candidates.draws, 2000);
  int at_limits = 0;
  for (int k = 0; k < 2000; ++k) {
    for (int j = 0; j < 5; ++j) {
      const double q = candidates.joint_values(j, k);
      EXPECT_GE(q, arm.joints[j].lower - 1e-12);
      EXPECT_LE(q, arm.joints[j].upper + 1e-12);
      const double steps = q / kDegree * 100.0;
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
      if (std::abs(q - arm.joints[j].lower) < 1e-9 ||
          std::abs(q - arm.joints[j].upper) < 1e-9) {
        ++at_limits;
      }
    }
  }
  // Two thirds of the joints of every other candidate: 3333 of 10 000, with a
  // standard deviation of 33.
  EXPECT_NEAR(at_limits, 3333, 150);
}

TEST(DrawCandidatesTest, RoundingDoesNotLeaveTheLimits) {
  Arm arm = Rv2ajFlange();
  arm.joints[0].upper = 100.006 * kDegree;  // rounds to 100.01
  arm.joints[0].lower = -100.006 * kDegree;
  const Candidates candidates = DrawCandidates(arm, {}, Options(200));
  EXPECT_NEAR(candidates.joint_values.row(0).maxCoeff(), 100.0 * kDegree,
              1e-12);
  EXPECT_NEAR(candidates.joint_values.row(0).minCoeff(), -100.0 * kDegree,
              1e-12);
}

TEST(DrawCandidatesTest, SeedsDiffer) {
  CandidateOptions options = Options(50);
  const Eigen::MatrixXd first =
      DrawCandidates(Rv2ajFlange(), {}, options).joint_values;
  EXPECT_EQ(first, DrawCandidates(Rv2ajFlange(), {}, options).joint_values);
  options.seed = 2;
  EXPECT_NE(first, DrawCandidates(Rv2ajFlange(), {}, options).joint_values);
}

TEST(DrawCandidatesTest, ImpossibleConstraintsComeToAnEnd) {
  PoseConstraints constraints;
  constraints.boxes.push_back({{9.0, 9.0, 9.0}, {10.0, 10.0, 10.0}});
  CandidateOptions options = Options(10);
  options.max_draws = 20;
  const Candidates candidates =
      DrawCandidates(Rv2ajFlange(), constraints, options);
  EXPECT_EQ(candidates.joint_values.cols(), 0);
  EXPECT_EQ(candidates.draws, 200);
}

TEST(AreOutOfReachTest, AllOfThemHaveToBe) {
  // Straight up, the flange is at 782 mm.
  Arm arm = Rv2ajFlange();
  const WorkspaceBox above{{-0.1, -0.1, 0.78}, {0.1, 0.1, 3.0}};
  const WorkspaceBox around{{-9.0, -9.0, -9.0}, {9.0, 9.0, 9.0}};
  const WorkspaceBox far{{-0.1, -3.0, 0.0}, {0.1, -1.5, 0.1}};
  EXPECT_FALSE(AreOutOfReach(arm, {}));
  EXPECT_FALSE(AreOutOfReach(arm, {above}));
  EXPECT_FALSE(AreOutOfReach(arm, {around}));
  EXPECT_FALSE(AreOutOfReach(arm, {far, above}));
  EXPECT_TRUE(AreOutOfReach(arm, {far, far}));
  // Boxes are in the base's frame, wherever the instrument is; a tool is part
  // of the arm.
  arm.instrument_from_base.translation() << 9.0, 0.0, 0.0;
  EXPECT_TRUE(AreOutOfReach(arm, {far}));
  arm.last_from_target().translation() << 0.0, 0.0, 1.0;
  EXPECT_FALSE(AreOutOfReach(arm, {far}));
  arm.last_from_target().translation().setZero();
  const double reach = ArmReach(arm);
  EXPECT_FALSE(AreOutOfReach(arm, {{{1.09 * reach, 0.0, 0.0}, {9, 9, 9}}}));
  EXPECT_TRUE(AreOutOfReach(arm, {{{1.11 * reach, 0.0, 0.0}, {9, 9, 9}}}));
  arm.joints[0].type = JointType::kPrismatic;
  arm.joints[0].lower = 0.0;
  arm.joints[0].upper = 2.0;
  EXPECT_FALSE(AreOutOfReach(arm, {far}));
  arm.joints[0].upper = 0.1;
  EXPECT_TRUE(AreOutOfReach(arm, {far}));
  arm.joints[0].upper = kInfinity;
  EXPECT_FALSE(AreOutOfReach(arm, {far}));
}

// The arm straight up: shoulder at 300, elbow at 550, wrist at 710, flange at
// 782 mm, looking up. Bent forward by 90 deg at the shoulder all lie at 300 mm.
class PoseConstraintsTest : public ::testing::Test {
 protected:
  bool Allows(double shoulder_deg) const {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(5);
    q[1] = shoulder_deg * kDegree;
    return IsAllowedPose(Rv2ajFlange(), constraints_, q);
  }

  PoseConstraints constraints_;
};

TEST_F(PoseConstraintsTest, NoneAllowsAll) { EXPECT_TRUE(Allows(110.0)); }

TEST_F(PoseConstraintsTest, BoxHoldsTheTarget) {
  constraints_.boxes.push_back({{-0.01, -0.01, 0.781}, {0.01, 0.01, 0.783}});
  EXPECT_TRUE(Allows(0.0));
  EXPECT_FALSE(Allows(90.0));
  constraints_.boxes.push_back({{0.48, -0.01, 0.299}, {0.49, 0.01, 0.301}});
  EXPECT_TRUE(Allows(90.0));
}

TEST_F(PoseConstraintsTest, FloorKeepsLinksAndTargetOff) {
  HalfSpace floor;
  floor.offset = 0.2;
  floor.margin = 0.0999;
  constraints_.half_spaces.push_back(floor);
  EXPECT_TRUE(Allows(90.0));
  constraints_.half_spaces[0].margin = 0.1001;
  EXPECT_FALSE(Allows(90.0));
}

// A ceiling that only the target is above of, then one that the elbow is.
TEST_F(PoseConstraintsTest, WallsLookInAnyDirection) {
  HalfSpace ceiling;
  ceiling.normal = -Eigen::Vector3d::UnitZ();
  ceiling.offset = -0.75;
  constraints_.half_spaces.push_back(ceiling);
  EXPECT_FALSE(Allows(0.0));
  EXPECT_TRUE(Allows(90.0));
  constraints_.half_spaces[0].offset = -0.29;
  EXPECT_FALSE(Allows(90.0));
}

TEST_F(PoseConstraintsTest, InstrumentSeesWithinTheCone) {
  Visibility visibility;
  visibility.instrument = Eigen::Vector3d(0.0, 0.0, 3.0);
  visibility.angle = 10.0 * kDegree;
  constraints_.visibility = visibility;
  EXPECT_TRUE(Allows(0.0));
  // Tilted by 9 deg the target looks 9 deg off the vertical, and stands 75 mm
  // off it, which is another 2 deg.
  EXPECT_FALSE(Allows(9.0));
  EXPECT_TRUE(Allows(7.0));
}

TEST(ShortOrderTest, PointsOnALineAreSorted) {
  Eigen::MatrixXd points(2, 7);
  points << 3.0, 1.0, 6.0, 0.0, 2.0, 5.0, 4.0,  //
      0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  const Eigen::Vector2d weights(1.0, 1.0);
  const std::vector<int> order = ShortOrder(points, weights);
  EXPECT_NEAR(TravelAlong(points, weights, order), 6.0, 1e-12);
}

// Against all 5040 orders of seven poses.
TEST(ShortOrderTest, IsNearlyTheShortest) {
  Random random(11);
  const Eigen::Vector3d weights(1.0, 0.5, 2.0);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::MatrixXd points(3, 7);
    for (double& entry : points.reshaped()) entry = random.Uniform();
    std::vector<int> order = {0, 1, 2, 3, 4, 5, 6};
    double shortest = 1e9;
    do {
      shortest = std::min(shortest, TravelAlong(points, weights, order));
    } while (std::next_permutation(order.begin(), order.end()));
    std::vector<int> found = ShortOrder(points, weights);
    const double travel = TravelAlong(points, weights, found);
    EXPECT_GE(travel, shortest - 1e-12);
    EXPECT_LE(travel, 1.05 * shortest);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
  }
}

// What the rules of docs/files.md say of a pose, by matrix products: arms of
// any joints, base and two targets, of which the second is measured.
bool AllowedByMatrices(const Arm& arm, const PoseConstraints& constraints,
                       const double* joints) {
  const ParameterLayout layout(arm);
  const testing::VectorXl values = testing::MatrixValues(arm);
  std::vector<testing::Vector3l> points;
  testing::Matrix4l frame = testing::Matrix4l::Identity();
  for (int j = 0; j < arm.num_joints(); ++j) {
    frame = frame * testing::JointMatrix(arm, layout, values, j, joints[j]);
    if (j > 0) points.emplace_back(frame.topRightCorner<3, 1>());
  }
  const auto target_frame = [&](int target) -> testing::Matrix4l {
    return frame * arm.last_from_target(target).matrix().cast<long double>();
  };
  for (int target = 0; target < arm.num_targets(); ++target) {
    points.emplace_back(target_frame(target).topRightCorner<3, 1>());
  }
  const HalfSpace& wall = constraints.half_spaces.front();
  for (const testing::Vector3l& point : points) {
    if (wall.normal.cast<long double>().dot(point) <
        wall.offset + wall.margin) {
      return false;
    }
  }
  const testing::Matrix4l measured = target_frame(constraints.targets.front());
  const testing::Vector3l at = measured.topRightCorner<3, 1>();
  const WorkspaceBox& box = constraints.boxes.front();
  for (int k = 0; k < 3; ++k) {
    if (at[k] < box.lower[k] || at[k] > box.upper[k]) return false;
  }
  const Visibility& seen = *constraints.visibility;
  const testing::Vector3l way = seen.instrument.cast<long double>() - at;
  const testing::Vector3l axis =
      measured.topLeftCorner<3, 3>() * seen.axis.cast<long double>();
  return std::acos(axis.dot(way) / way.norm()) <= seen.angle;
}

// Loose enough constraints that all answers occur, with and without each.
TEST(IsAllowedPoseTest, AgreesWithMatricesForAnyArmAndTarget) {
  Random random(31);
  int allowed = 0;
  constexpr int kPoses = 2000;
  for (int k = 0; k < kPoses; ++k) {
    testing::RandomArmOptions options;
    options.num_targets = 2;
    const Arm arm = testing::RandomArm(1 + k % 7, &random, options);
    PoseConstraints constraints;
    constraints.targets = {1};
    HalfSpace wall;
    wall.normal = testing::RandomDirection(&random);
    wall.offset = -0.8;
    wall.margin = 0.05;
    constraints.half_spaces = {wall};
    constraints.boxes = {{{-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}}};
    Visibility visibility;
    visibility.instrument = testing::RandomVector(3.0, &random);
    visibility.axis = testing::RandomDirection(&random);
    visibility.angle = 130.0 * kDegree;
    constraints.visibility = visibility;
    const Eigen::VectorXd joints =
        testing::RandomJointValues(arm, 1, &random).col(0);
    const bool expected = AllowedByMatrices(arm, constraints, joints.data());
    EXPECT_EQ(IsAllowedPose(arm, constraints, joints), expected) << k;
    allowed += expected ? 1 : 0;
  }
  EXPECT_GT(allowed, kPoses / 10);
  EXPECT_LT(allowed, kPoses * 9 / 10);
}

}  // namespace
}  // namespace alidade::internal
