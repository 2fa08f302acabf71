#include "src/initialization/frame_start.h"

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

// Noise makes the fit a compromise, flat points leave a reflection open.
TEST(FitRigidTest, AgreesWithUmeyama) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(13, seed);
    const Eigen::Isometry3d truth = RandomFrame(5.0, &random);
    Eigen::Matrix3Xd points(3, 4 + seed);
    for (auto point : points.colwise()) point = RandomVector(0.5, &random);
    if (seed % 2 == 0) points.row(2).setZero();
    Eigen::Matrix3Xd measured = truth * points;
    for (auto point : measured.colwise()) point += RandomVector(0.02, &random);
    const auto fit = FitRigid(points, measured);
    ASSERT_TRUE(fit);
    ASSERT_TRUE(fit->is_unique);
    Eigen::Isometry3d expected;
    expected.matrix() = Eigen::umeyama(points, measured, false);
    ExpectSameFrame(fit->b_from_a, expected, 1e-12, 1e-12);
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
  // Flat points could be reflected without a residual.
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
  problem->measured = Eigen::MatrixXd(3, num);
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

}  // namespace
}  // namespace alidade::internal
