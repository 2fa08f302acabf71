#include "alidade/measurement/frame_start.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/model/rotation.h"

namespace alidade {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

constexpr double kPi = 3.14159265358979323846;

// The prior moves targets by some 1e-11 m where the fit is exact.
constexpr double kExact = 1e-8;

Eigen::Vector3d RandomVector(double half_width, Random* random) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = random->Uniform(-half_width, half_width);
  return vector;
}

Eigen::Vector3d NormalVector(double stddev, Random* random) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = stddev * random->Normal();
  return vector;
}

// Any rotation, half a turn too.
Eigen::Isometry3d RandomFrame(double half_width, Random* random) {
  const Eigen::Vector3d axis = NormalVector(1.0, random).normalized();
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() =
      RotationFromVector<double>(random->Uniform(-kPi, kPi) * axis);
  frame.translation() = RandomVector(half_width, random);
  return frame;
}

// A six-axis arm of 0.9 m with joints within +- 100 degrees.
Poses RandomFlangePoses(int num_poses, Random* random) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Poses poses;
  for (int i = 0; i < num_poses; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const auto turn = [&](const Eigen::Vector3d& axis) {
      pose.rotate(Eigen::AngleAxisd(random->Uniform(-1.75, 1.75), axis));
    };
    turn(z);
    turn(y);
    pose.translate(0.4 * z);
    turn(y);
    pose.translate(0.4 * z);
    turn(z);
    turn(y);
    pose.translate(0.1 * z);
    turn(z);
    poses.push_back(pose);
  }
  return poses;
}

// Flange poses whose orientations are all alike.
Poses ParallelFlangePoses(int num_poses, Random* random) {
  const Eigen::Isometry3d frame = RandomFrame(0.0, random);
  Poses poses(num_poses, frame);
  for (auto& pose : poses) pose.translation() = RandomVector(0.5, random);
  return poses;
}

// As an arm that differs from its nominal by some mm and mrad.
Poses Disturbed(Poses poses, Random* random) {
  for (auto& pose : poses) {
    pose.translation() += NormalVector(0.003, random);
    pose.linear() =
        RotationFromVector<double>(NormalVector(0.005, random)) * pose.linear();
  }
  return poses;
}

double TurnBetween(const Eigen::Isometry3d& one, const Eigen::Isometry3d& two) {
  return VectorFromRotation(one.linear().transpose() * two.linear()).norm();
}

void ExpectSameFrame(const Eigen::Isometry3d& found,
                     const Eigen::Isometry3d& truth, double metres,
                     double radians) {
  EXPECT_NEAR((found.translation() - truth.translation()).norm(), 0.0, metres);
  EXPECT_NEAR(TurnBetween(found, truth), 0.0, radians);
  EXPECT_NEAR(found.linear().determinant(), 1.0, 1e-12);
}

TEST(FitRigidTest, RecoversFramesAndScale) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(11, seed);
    const Eigen::Isometry3d truth = RandomFrame(5.0, &random);
    Eigen::Matrix3Xd points(3, 4 + seed);
    for (auto point : points.colwise()) point = RandomVector(0.5, &random);
    const auto fit = FitRigid(points, truth * points);
    ASSERT_TRUE(fit);
    ExpectSameFrame(fit->b_from_a, truth, 1e-12, 1e-12);
    EXPECT_NEAR(fit->scale, 1.0, 1e-12);
    EXPECT_NEAR(fit->rms, 0.0, 1e-13);
    EXPECT_TRUE(fit->is_unique);
    const auto in_mm = FitRigid(points, 1e3 * (truth * points));
    ASSERT_TRUE(in_mm);
    EXPECT_NEAR(in_mm->scale, 1e3, 1e-9);
  }
}

TEST(FitRigidTest, NeverReflects) {
  Random random(12);
  Eigen::Matrix3Xd points(3, 10);
  for (auto point : points.colwise()) point = RandomVector(0.5, &random);
  const auto fit = FitRigid(points, -points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->b_from_a.linear().determinant(), 1.0, 1e-12);
  EXPECT_GT(fit->rms, 0.1);
  // Flat points could be reflected without a misfit.
  points.row(2).setZero();
  const Eigen::Isometry3d truth = RandomFrame(5.0, &random);
  const auto flat = FitRigid(points, truth * points);
  ASSERT_TRUE(flat);
  EXPECT_TRUE(flat->is_unique);
  ExpectSameFrame(flat->b_from_a, truth, 1e-12, 1e-12);
}

TEST(FitRigidTest, PointsOnALineGetTheSmallestTurn) {
  const Eigen::Vector3d along(1.0, 2.0, 3.0);
  Eigen::Matrix3Xd points(3, 4);
  for (int i = 0; i < 4; ++i) points.col(i) = (0.1 * i + 0.3) * along;
  const Eigen::Vector3d turn =
      0.7 * along.cross(Eigen::Vector3d::UnitX()).normalized();
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.linear() = RotationFromVector<double>(turn);
  truth.translation() << 4.0, -3.0, 2.0;
  const auto fit = FitRigid(points, truth * points);
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->is_unique);
  // The turn is at right angles with the line, so that none is smaller.
  ExpectSameFrame(fit->b_from_a, truth, 1e-9, 1e-9);
  EXPECT_NEAR(fit->rms, 0.0, 1e-9);
}

TEST(FitRigidTest, PointsThatCoincideAreOnlyMoved) {
  const Eigen::Matrix3Xd a = Eigen::Vector3d(1.0, 2.0, 3.0).replicate(1, 3);
  const Eigen::Matrix3Xd b = Eigen::Vector3d(1.5, 2.0, 1.0).replicate(1, 3);
  const auto fit = FitRigid(a, b);
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->is_unique);
  EXPECT_NEAR(fit->rms, 0.0, 1e-12);
  EXPECT_NEAR((fit->b_from_a.linear() - Eigen::Matrix3d::Identity()).norm(),
              0.0, 1e-12);
}

TEST(FitRigidTest, RefusesTooFewAndUnusablePoints) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 3);
  EXPECT_TRUE(FitRigid(points, points));
  EXPECT_FALSE(FitRigid(points.leftCols(2), points.leftCols(2)));
  EXPECT_FALSE(FitRigid(points, points.leftCols(2)));
  Eigen::Matrix3Xd broken = points;
  broken(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FitRigid(points, broken));
}

// A problem of positions, its base metres off and turned in any way.
struct PositionProblem {
  Poses base_from_last;
  Eigen::Isometry3d instrument_from_base;
  Eigen::Matrix3Xd targets;
  std::vector<int> target_of_observation;
  Eigen::Matrix3Xd measured;
};

void Measure(PositionProblem* problem) {
  const auto num = static_cast<int>(problem->base_from_last.size());
  problem->measured.resize(3, num);
  problem->target_of_observation.clear();
  for (int i = 0; i < num; ++i) {
    const int k = i % static_cast<int>(problem->targets.cols());
    problem->target_of_observation.push_back(k);
    problem->measured.col(i) = problem->instrument_from_base *
                               problem->base_from_last[i] *
                               problem->targets.col(k);
  }
}

PositionProblem RandomPositions(int num_poses, int num_targets,
                                Random* random) {
  PositionProblem problem;
  problem.base_from_last = RandomFlangePoses(num_poses, random);
  problem.instrument_from_base = RandomFrame(5.0, random);
  problem.targets.resize(3, num_targets);
  for (auto target : problem.targets.colwise()) {
    target =
        random->Uniform(0.05, 0.4) * NormalVector(1.0, random).normalized();
  }
  Measure(&problem);
  return problem;
}

std::optional<PositionStart> Start(const PositionProblem& problem) {
  return StartFromPositions(problem.base_from_last, problem.measured,
                            problem.target_of_observation,
                            static_cast<int>(problem.targets.cols()));
}

class PositionStartTest : public ::testing::TestWithParam<int> {};

TEST_P(PositionStartTest, RecoversBaseAndTargetsExactly) {
  const int num_targets = GetParam();
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(21, seed);
    const PositionProblem problem =
        RandomPositions(10 * num_targets + seed, num_targets, &random);
    const auto start = Start(problem);
    ASSERT_TRUE(start);
    ExpectSameFrame(start->instrument_from_base, problem.instrument_from_base,
                    kExact, kExact);
    EXPECT_NEAR((start->targets - problem.targets).norm(), 0.0, kExact);
    EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
    EXPECT_EQ(start->misfit.num_outliers, 0);
  }
}

TEST_P(PositionStartTest, ComesNearWithANominalArmNoiseAndOutliers) {
  const int num_targets = GetParam();
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(22, seed);
    PositionProblem problem = RandomPositions(60, num_targets, &random);
    problem.base_from_last = Disturbed(problem.base_from_last, &random);
    for (int i = 0; i < 60; i += 10) {
      problem.measured.col(i) += RandomVector(3.0, &random);
    }
    const auto start = Start(problem);
    ASSERT_TRUE(start);
    // 5 mm per observation, some 20 of them per target: five deviations.
    ExpectSameFrame(start->instrument_from_base, problem.instrument_from_base,
                    0.008, 0.02);
    EXPECT_LT((start->targets - problem.targets).colwise().norm().maxCoeff(),
              0.012);
    EXPECT_GT(start->misfit.median, 0.002);
    EXPECT_LT(start->misfit.median, 0.012);
    EXPECT_GE(start->misfit.num_outliers, 5);
    EXPECT_LE(start->misfit.num_outliers, 7);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, PositionStartTest,
                         ::testing::Values(1, 2, 3));

TEST(PositionStartCaseTest, RecoversHalfTurnsOfTheBase) {
  for (int axis = 0; axis < 3; ++axis) {
    Random random(23, axis);
    PositionProblem problem = RandomPositions(20, 1, &random);
    problem.instrument_from_base.linear() =
        Eigen::AngleAxisd(kPi, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
    Measure(&problem);
    const auto start = Start(problem);
    ASSERT_TRUE(start);
    ExpectSameFrame(start->instrument_from_base, problem.instrument_from_base,
                    kExact, kExact);
    EXPECT_NEAR((start->targets - problem.targets).norm(), 0.0, kExact);
  }
}

TEST(PositionStartCaseTest, GrossOutliersAloneDoNoHarm) {
  Random random(24);
  PositionProblem problem = RandomPositions(40, 2, &random);
  for (int i = 0; i < 40; i += 10) {
    problem.measured.col(i) += RandomVector(1.0, &random);
  }
  const auto start = Start(problem);
  ASSERT_TRUE(start);
  ExpectSameFrame(start->instrument_from_base, problem.instrument_from_base,
                  kExact, kExact);
  EXPECT_EQ(start->misfit.num_outliers, 4);
}

TEST(PositionStartCaseTest, ParallelFlangesLeaveTheTargetAtZero) {
  Random random(25);
  PositionProblem problem = RandomPositions(20, 1, &random);
  problem.base_from_last = ParallelFlangePoses(20, &random);
  Measure(&problem);
  const auto start = Start(problem);
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->targets.norm(), 0.0, 1e-6);
  EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
  EXPECT_NEAR(
      TurnBetween(start->instrument_from_base, problem.instrument_from_base),
      0.0, kExact);
}

TEST(PositionStartCaseTest, NearlyParallelFlangesKeepTheTargetSmall) {
  Random random(26);
  PositionProblem problem = RandomPositions(20, 1, &random);
  problem.base_from_last = ParallelFlangePoses(20, &random);
  Measure(&problem);
  problem.base_from_last = Disturbed(problem.base_from_last, &random);
  const auto start = Start(problem);
  ASSERT_TRUE(start);
  EXPECT_LT(start->targets.norm(), 0.5);
  EXPECT_LT(start->misfit.rms, 0.01);
}

// Orientations about z only: the target's height and the base's are one.
TEST(PositionStartCaseTest, TargetAlongTheOnlyAxisOfTurnsStaysAtZero) {
  Random random(27);
  PositionProblem problem = RandomPositions(30, 1, &random);
  for (auto& pose : problem.base_from_last) {
    pose.linear() =
        Eigen::AngleAxisd(random.Uniform(-kPi, kPi), Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
  }
  problem.targets.col(0) << 0.1, -0.2, 0.3;
  Measure(&problem);
  const auto start = Start(problem);
  ASSERT_TRUE(start);
  EXPECT_NEAR((start->targets.col(0) - Eigen::Vector3d(0.1, -0.2, 0.0)).norm(),
              0.0, 1e-6);
  EXPECT_NEAR(start->misfit.rms, 0.0, kExact);
}

TEST(PositionStartCaseTest, RefusesTooFewAndUnusableObservations) {
  Random random(28);
  const PositionProblem problem = RandomPositions(4, 1, &random);
  EXPECT_TRUE(Start(problem));
  const Poses& poses = problem.base_from_last;
  const Eigen::Matrix3Xd& measured = problem.measured;
  EXPECT_FALSE(StartFromPositions({poses[0], poses[1]}, measured.leftCols(2),
                                  {0, 0}, 1));
  EXPECT_FALSE(StartFromPositions(poses, measured, {0, 0, 0}, 1));
  EXPECT_FALSE(StartFromPositions(poses, measured, {0, 0, 0, 1}, 1));
  EXPECT_FALSE(StartFromPositions(poses, measured, {0, 0, 0, -1}, 1));
  EXPECT_FALSE(StartFromPositions(poses, measured, {0, 0, 0, 0}, 2));
  EXPECT_FALSE(StartFromPositions(poses, measured, {0, 0, 1, 2}, 3));
  EXPECT_FALSE(StartFromPositions({}, Eigen::Matrix3Xd(3, 0), {}, 0));
}

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
}  // namespace alidade
