#include "src/error_terms/folds.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "src/common/random.h"

namespace alidade::internal {
namespace {

// Random joint values; every configuration `repeats` times, not in a row.
Dataset DataOf(int configurations, int repeats, std::uint64_t seed = 1) {
  Random random(seed);
  Eigen::MatrixXd q(4, configurations);
  for (double& value : q.reshaped()) value = random.Uniform(-2.0, 2.0);
  // Of small range: distances are over the spread.
  q.row(3) *= 1e-3;
  const Eigen::MatrixXd all = q.replicate(1, repeats);
  return MakePositions(all, Eigen::Matrix3Xd::Zero(3, all.cols()), 1e-4);
}

int Count(const std::vector<bool>& taken) {
  return static_cast<int>(std::count(taken.begin(), taken.end(), true));
}

TEST(FoldsTest, RegionsAreOfTheFraction) {
  for (const int count : {20, 60, 203, 1000}) {
    const Dataset data = DataOf(count, 1);
    for (const double fraction : {0.1, 0.25, 0.5}) {
      const int taken = Count(RegionOf(data, fraction, 7));
      EXPECT_GE(taken, fraction * count);
      // The last neighbourhood, a twentieth, may go beyond.
      EXPECT_LE(taken, fraction * count + count / 20.0 + 1.0);
    }
  }
}

TEST(FoldsTest, RegionIsOfNeighbours) {
  // Nearest neighbours of those taken are taken much more often than by chance.
  const Dataset data = DataOf(400, 1);
  const std::vector<bool> region = RegionOf(data, 0.25, 3);
  Eigen::MatrixXd scaled = data.joint_values.map();
  scaled.row(3) *= 1e3;
  int same = 0;
  for (int k = 0; k < 400; ++k) {
    if (!region[k]) continue;
    Eigen::VectorXd distances =
        (scaled.colwise() - scaled.col(k)).colwise().squaredNorm();
    distances[k] = 1e9;
    Eigen::Index nearest = 0;
    distances.minCoeff(&nearest);
    same += region[nearest] ? 1 : 0;
  }
  EXPECT_GT(same, 0.6 * Count(region));
}

TEST(FoldsTest, RepeatsStayTogether) {
  const Dataset data = DataOf(50, 3);
  const TrainingFolds folds = MakeTrainingFolds(data);
  std::vector<std::vector<bool>> all = folds.left_out;
  all.push_back(RegionOf(data, 0.3, 4));
  all.push_back(BlocksOf(data, 0.3, 4));
  for (const std::vector<bool>& taken : all) {
    ASSERT_EQ(taken.size(), 150U);
    for (int k = 0; k < 50; ++k) {
      EXPECT_EQ(taken[k], taken[k + 50]);
      EXPECT_EQ(taken[k], taken[k + 100]);
    }
  }
}

TEST(FoldsTest, RandomFoldsCoverEachPoseOnce) {
  const TrainingFolds folds = MakeTrainingFolds(DataOf(63, 1));
  ASSERT_EQ(folds.left_out.size(), 13U);
  for (int k = 0; k < TrainingFolds::kRegions; ++k) {
    EXPECT_GE(Count(folds.left_out[k]), 16);
    EXPECT_LE(Count(folds.left_out[k]), 19);
  }
  for (int pose = 0; pose < 63; ++pose) {
    int times = 0;
    for (int k = TrainingFolds::kRegions; k < 13; ++k) {
      times += folds.left_out[k][pose] ? 1 : 0;
    }
    EXPECT_EQ(times, 1) << pose;
  }
  for (int k = TrainingFolds::kRegions; k < 13; ++k) {
    EXPECT_GE(Count(folds.left_out[k]), 12);
    EXPECT_LE(Count(folds.left_out[k]), 13);
  }
}

TEST(FoldsTest, BlocksAreRunsOfPoses) {
  const Dataset data = DataOf(400, 1);
  for (const double fraction : {0.001, 0.25, 0.5, 0.999}) {
    const std::vector<bool> taken = BlocksOf(data, fraction, 9);
    const double met = std::clamp(fraction, 0.05, 0.95);
    EXPECT_EQ(Count(taken), static_cast<int>(std::lround(400 * met)));
    // Of twenty runs of twenty each.
    for (int k = 0; k < 400; ++k) EXPECT_EQ(taken[k], taken[k / 20 * 20]);
  }
}

TEST(FoldsTest, SeedDecides) {
  const Dataset data = DataOf(200, 1);
  EXPECT_EQ(RegionOf(data, 0.25, 5), RegionOf(data, 0.25, 5));
  EXPECT_NE(RegionOf(data, 0.25, 5), RegionOf(data, 0.25, 6));
  EXPECT_EQ(BlocksOf(data, 0.25, 5), BlocksOf(data, 0.25, 5));
  EXPECT_NE(BlocksOf(data, 0.25, 5), BlocksOf(data, 0.25, 6));
  EXPECT_EQ(MakeTrainingFolds(data).left_out, MakeTrainingFolds(data).left_out);
  std::set<std::vector<bool>> different;
  for (const std::vector<bool>& fold : MakeTrainingFolds(data).left_out) {
    different.insert(fold);
  }
  EXPECT_EQ(different.size(), 13U);
}

TEST(FoldsTest, FewOrStillPosesAreNoTrouble) {
  EXPECT_EQ(Count(RegionOf(DataOf(1, 1), 0.25, 1)), 1);
  EXPECT_EQ(Count(RegionOf(DataOf(3, 1), 0.25, 1)), 1);
  Dataset still = DataOf(30, 1);
  still.joint_values = Eigen::MatrixXd::Constant(4, 30, 0.5);
  // One configuration thirty times.
  EXPECT_EQ(Count(RegionOf(still, 0.25, 1)), 30);
  EXPECT_EQ(MakeTrainingFolds(still).left_out.size(), 13U);
}

}  // namespace
}  // namespace alidade::internal
