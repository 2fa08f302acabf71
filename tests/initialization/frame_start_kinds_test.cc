// Starts from poses, fixed points, distances and planes.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/initialization/frame_start.h"
#include "tests/initialization/frame_start_util.h"

namespace alidade::internal {
namespace {

using testing::Disturbed;
using testing::ExpectSameFrame;
using testing::kExact;
using testing::NormalVector;
using testing::ParallelFlangePoses;
using testing::Poses;
using testing::RandomFlangePoses;
using testing::RandomFrame;
using testing::RandomVector;
using testing::TurnBetween;

Poses MeasuredPoses(const Poses& base_from_last, const Eigen::Isometry3d& base,
                    const Eigen::Isometry3d& last_from_target) {
  Poses measured;
  for (const auto& pose : base_from_last) {
    measured.push_back(base * pose * last_from_target);
  }
  return measured;
}

TEST(PoseStartTest, RecoversBothFramesExactly) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(31, seed);
    const Poses poses = RandomFlangePoses(4 + seed, &random);
    const Eigen::Isometry3d base = RandomFrame(5.0, &random);
    const Eigen::Isometry3d target = RandomFrame(0.2, &random);
    const auto start =
        StartFromPoses(poses, MeasuredPoses(poses, base, target));
    ASSERT_TRUE(start);
    ExpectSameFrame(start->instrument_from_base, base, kExact, kExact);
    ExpectSameFrame(start->last_from_target, target, kExact, kExact);
    EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
    EXPECT_NEAR(start->rms_rotation, 0.0, kExact);
  }
}

TEST(PoseStartTest, ComesNearWithANominalArmAndOutliers) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(32, seed);
    const Poses poses = RandomFlangePoses(40, &random);
    const Eigen::Isometry3d base = RandomFrame(5.0, &random);
    const Eigen::Isometry3d target = RandomFrame(0.2, &random);
    Poses measured = MeasuredPoses(poses, base, target);
    for (int i = 0; i < 40; i += 10) measured[i] = RandomFrame(5.0, &random);
    const auto start = StartFromPoses(Disturbed(poses, &random), measured);
    ASSERT_TRUE(start);
    ExpectSameFrame(start->instrument_from_base, base, 0.008, 0.015);
    ExpectSameFrame(start->last_from_target, target, 0.008, 0.015);
    EXPECT_GE(start->misfit.num_outliers, 4);
    EXPECT_LE(start->misfit.num_outliers, 5);
  }
}

TEST(PoseStartTest, ParallelFlangesLeaveTheTargetAtTheLastJoint) {
  Random random(33);
  const Poses poses = ParallelFlangePoses(20, &random);
  const Eigen::Isometry3d base = RandomFrame(5.0, &random);
  const auto start = StartFromPoses(
      poses, MeasuredPoses(poses, base, RandomFrame(0.2, &random)));
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->last_from_target.translation().norm(), 0.0, 1e-6);
  EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
  // The positions tell the base's rotation and so the target's.
  EXPECT_NEAR(TurnBetween(start->instrument_from_base, base), 0.0, kExact);
}

// The positions tell the base's rotation where turns about one axis do not.
TEST(PoseStartTest, TurnsAboutOneAxisLeaveTheTargetsHeightAtZero) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(35, seed);
    Poses poses = ParallelFlangePoses(12, &random);
    for (auto& pose : poses) {
      pose.linear() =
          Eigen::AngleAxisd(random.Uniform(-kPi, kPi), Eigen::Vector3d::UnitZ())
              .toRotationMatrix();
    }
    const Eigen::Isometry3d base = RandomFrame(5.0, &random);
    const Eigen::Isometry3d target = RandomFrame(0.2, &random);
    const auto start =
        StartFromPoses(poses, MeasuredPoses(poses, base, target));
    ASSERT_TRUE(start);
    EXPECT_NEAR(TurnBetween(start->instrument_from_base, base), 0.0, kExact);
    EXPECT_NEAR(TurnBetween(start->last_from_target, target), 0.0, kExact);
    Eigen::Vector3d without_height = target.translation();
    without_height.z() = 0.0;
    EXPECT_NEAR((start->last_from_target.translation() - without_height).norm(),
                0.0, 1e-6);
    EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
  }
}

TEST(PoseStartTest, RefusesTooFew) {
  Random random(34);
  const Poses poses = RandomFlangePoses(2, &random);
  EXPECT_FALSE(StartFromPoses(poses, poses));
  EXPECT_FALSE(StartFromPoses(RandomFlangePoses(4, &random), poses));
}

// Flange poses that put the target on a point, each in an orientation of its
// own.
Poses PosesAt(const Eigen::Matrix3Xd& points_in_base,
              const Eigen::Vector3d& target, Random* random) {
  Poses poses;
  for (const auto point : points_in_base.colwise()) {
    Eigen::Isometry3d pose = RandomFrame(0.0, random);
    pose.translation() = point - pose.linear() * target;
    poses.push_back(pose);
  }
  return poses;
}

struct PointProblem {
  Eigen::Matrix3Xd points;  ///< in the base's frame
  Eigen::Vector3d target;
  std::vector<int> point_of_observation;
  Poses base_from_last;
};

PointProblem RandomPoints(int num_points, int num_observations,
                          Random* random) {
  PointProblem problem;
  problem.points.resize(3, num_points);
  for (auto point : problem.points.colwise()) point = RandomVector(0.6, random);
  problem.target = RandomVector(0.3, random);
  Eigen::Matrix3Xd touched(3, num_observations);
  for (int i = 0; i < num_observations; ++i) {
    problem.point_of_observation.push_back(i % num_points);
    touched.col(i) = problem.points.col(i % num_points);
  }
  problem.base_from_last = PosesAt(touched, problem.target, random);
  return problem;
}

TEST(FixedPointStartTest, RecoversTargetAndPointsExactly) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(41, seed);
    const int num_points = 1 + seed % 3;
    const PointProblem problem =
        RandomPoints(num_points, 4 * num_points + seed, &random);
    const Eigen::Isometry3d base = RandomFrame(3.0, &random);
    const auto start = StartFromFixedPoints(
        base, problem.base_from_last, problem.point_of_observation, num_points);
    ASSERT_TRUE(start);
    EXPECT_NEAR((start->target - problem.target).norm(), 0.0, kExact);
    EXPECT_NEAR((start->points - base * problem.points).norm(), 0.0, kExact);
  }
}

TEST(FixedPointStartTest, OutliersDoNoHarm) {
  Random random(42);
  PointProblem problem = RandomPoints(2, 40, &random);
  for (int i = 0; i < 40; i += 10) {
    problem.base_from_last[i].translation() += RandomVector(0.5, &random);
  }
  const auto start = StartFromFixedPoints(Eigen::Isometry3d::Identity(),
                                          problem.base_from_last,
                                          problem.point_of_observation, 2);
  ASSERT_TRUE(start);
  EXPECT_NEAR((start->target - problem.target).norm(), 0.0, kExact);
  EXPECT_EQ(start->misfit.num_outliers, 4);
}

TEST(FixedPointStartTest, EqualPosesLeaveTheTargetAtZero) {
  Random random(43);
  const Poses poses(5, RandomFrame(0.5, &random));
  const auto start = StartFromFixedPoints(Eigen::Isometry3d::Identity(), poses,
                                          {0, 0, 0, 0, 0}, 1);
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->target.norm(), 0.0, 1e-6);
  EXPECT_NEAR((start->points.col(0) - poses[0].translation()).norm(), 0.0,
              1e-6);
}

TEST(FixedPointStartTest, RefusesTooFew) {
  Random random(44);
  const Poses poses = RandomFlangePoses(3, &random);
  const auto base = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(StartFromFixedPoints(base, {poses[0]}, {0}, 1));
  EXPECT_FALSE(StartFromFixedPoints(base, poses, {0, 1, 2}, 3));
  EXPECT_FALSE(StartFromFixedPoints(base, poses, {0, 0, 0}, 2));
}

Eigen::VectorXd Lengths(const Poses& poses, const Eigen::Vector3d& target,
                        const Eigen::Vector3d& anchor_in_base) {
  Eigen::VectorXd lengths(static_cast<Eigen::Index>(poses.size()));
  for (Eigen::Index i = 0; i < lengths.size(); ++i) {
    lengths[i] = (poses[i] * target - anchor_in_base).norm();
  }
  return lengths;
}

TEST(DistanceStartTest, RecoversAnchorAndTargetExactly) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(51, seed);
    const Poses poses = RandomFlangePoses(15 + seed, &random);
    const Eigen::Vector3d target = RandomVector(0.2, &random);
    const Eigen::Vector3d anchor = RandomVector(1.5, &random);
    const Eigen::Isometry3d base = RandomFrame(3.0, &random);
    const auto start =
        StartFromDistances(base, poses, Lengths(poses, target, anchor));
    ASSERT_TRUE(start);
    EXPECT_NEAR((start->anchor - base * anchor).norm(), 0.0, kExact);
    EXPECT_NEAR((start->target - target).norm(), 0.0, kExact);
    EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
  }
}

TEST(DistanceStartTest, ComesNearWithANominalArmAndOutliers) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(52, seed);
    const Poses poses = RandomFlangePoses(60, &random);
    const Eigen::Vector3d target = RandomVector(0.2, &random);
    const Eigen::Vector3d anchor = RandomVector(1.5, &random);
    Eigen::VectorXd lengths = Lengths(poses, target, anchor);
    for (int i = 0; i < 60; i += 10) lengths[i] += random.Uniform(0.1, 0.5);
    const auto start = StartFromDistances(Eigen::Isometry3d::Identity(),
                                          Disturbed(poses, &random), lengths);
    ASSERT_TRUE(start);
    EXPECT_NEAR((start->anchor - anchor).norm(), 0.0, 0.02);
    EXPECT_NEAR((start->target - target).norm(), 0.0, 0.02);
  }
}

TEST(DistanceStartTest, ParallelFlangesLeaveTheTargetAtZero) {
  Random random(53);
  const Poses poses = ParallelFlangePoses(20, &random);
  const Eigen::Vector3d target = RandomVector(0.2, &random);
  const Eigen::Vector3d anchor(1.0, 0.5, -0.4);
  const auto start = StartFromDistances(Eigen::Isometry3d::Identity(), poses,
                                        Lengths(poses, target, anchor));
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->target.norm(), 0.0, 1e-6);
  EXPECT_NEAR((start->anchor - (anchor - poses[0].linear() * target)).norm(),
              0.0, 1e-6);
}

TEST(DistanceStartTest, PointsOnAPlaneFindTheAnchorOrItsMirrorImage) {
  Random random(54);
  Poses poses = ParallelFlangePoses(12, &random);
  for (auto& pose : poses) pose.translation().z() = 0.0;
  const Eigen::Vector3d anchor(0.3, -0.2, 0.8);
  const auto start =
      StartFromDistances(Eigen::Isometry3d::Identity(), poses,
                         Lengths(poses, Eigen::Vector3d::Zero(), anchor));
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
  EXPECT_NEAR((start->anchor.head<2>() - anchor.head<2>()).norm(), 0.0, 1e-6);
  EXPECT_NEAR(std::abs(start->anchor.z()), 0.8, 1e-6);
}

TEST(DistanceStartTest, RefusesTooFew) {
  Random random(55);
  EXPECT_FALSE(StartFromDistances(Eigen::Isometry3d::Identity(),
                                  RandomFlangePoses(5, &random),
                                  Eigen::VectorXd::Ones(5)));
}

// Points in the base's frame on the plane normal . p = offset.
Eigen::Matrix3Xd PointsOnPlane(int num_points, const Eigen::Vector3d& normal,
                               double offset, Random* random) {
  Eigen::Matrix3Xd points(3, num_points);
  for (auto point : points.colwise()) {
    point = RandomVector(0.5, random);
    point += (offset - normal.dot(point)) * normal;
  }
  return points;
}

TEST(PlaneStartTest, RecoversPlaneAndTargetExactly) {
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(61, seed);
    const Eigen::Vector3d normal = NormalVector(1.0, &random).normalized();
    const double offset = random.Uniform(0.1, 0.5);
    const Eigen::Vector3d target = RandomVector(0.2, &random);
    const Poses poses = PosesAt(
        PointsOnPlane(15 + seed, normal, offset, &random), target, &random);
    const Eigen::Isometry3d base = RandomFrame(3.0, &random);
    const auto start = StartFromPlane(base, poses);
    ASSERT_TRUE(start);
    EXPECT_GE(start->offset, 0.0);
    const Eigen::Vector3d seen = base.linear() * normal;
    const double seen_offset = offset + seen.dot(base.translation());
    // The nearest point to the instrument says both, without their sign.
    EXPECT_NEAR((start->offset * start->normal - seen_offset * seen).norm(),
                0.0, kExact);
    EXPECT_NEAR((start->target - target).norm(), 0.0, kExact);
  }
}

TEST(PlaneStartTest, ComesNearWithANominalArmAndOutliers) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(62, seed);
    const Eigen::Vector3d normal = NormalVector(1.0, &random).normalized();
    const double offset = random.Uniform(0.1, 0.5);
    const Eigen::Vector3d target = RandomVector(0.2, &random);
    Eigen::Matrix3Xd points = PointsOnPlane(60, normal, offset, &random);
    for (int i = 0; i < 60; i += 10) points.col(i) += 0.2 * normal;
    const Poses poses = Disturbed(PosesAt(points, target, &random), &random);
    const auto start = StartFromPlane(Eigen::Isometry3d::Identity(), poses);
    ASSERT_TRUE(start);
    EXPECT_NEAR((start->normal - normal).norm(), 0.0, 0.02);
    EXPECT_NEAR(start->offset, offset, 0.01);
    EXPECT_NEAR((start->target - target).norm(), 0.0, 0.01);
  }
}

TEST(PlaneStartTest, ParallelFlangesLeaveTheTargetAtZero) {
  Random random(63);
  Poses poses = ParallelFlangePoses(12, &random);
  for (auto& pose : poses) pose.translation().z() = 0.2;
  const auto start = StartFromPlane(Eigen::Isometry3d::Identity(), poses);
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->target.norm(), 0.0, 1e-6);
  EXPECT_NEAR((start->normal - Eigen::Vector3d::UnitZ()).norm(), 0.0, kExact);
  EXPECT_NEAR(start->offset, 0.2, 1e-6);
}

TEST(PlaneStartTest, RefusesTooFew) {
  Random random(64);
  EXPECT_FALSE(StartFromPlane(Eigen::Isometry3d::Identity(),
                              RandomFlangePoses(5, &random)));
}

}  // namespace
}  // namespace alidade::internal
