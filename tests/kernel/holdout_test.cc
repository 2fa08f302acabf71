#include "src/kernel/holdout.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

// Row i stands at configuration configurations[i] and measures x = i.
Dataset RowsAt(const std::vector<double>& configurations) {
  const auto count = static_cast<Eigen::Index>(configurations.size());
  Dataset data;
  data.name = "rows";
  Eigen::MatrixXd joint_values(2, count);
  Eigen::MatrixXd positions = Eigen::MatrixXd::Zero(3, count);
  data.sigmas() = Eigen::MatrixXd::Constant(3, count, 1e-3);
  for (Eigen::Index i = 0; i < count; ++i) {
    joint_values.col(i) << 0.5, configurations[i];
    positions(0, i) = static_cast<double>(i);
  }
  data.joint_values = std::move(joint_values);
  data.positions() = std::move(positions);
  return data;
}

Dataset HundredConfigurations() {
  std::vector<double> configurations;
  for (int i = 0; i < 100; ++i) {
    for (int repeat = 0; repeat < 1 + i % 3; ++repeat) {
      configurations.push_back(i);
    }
  }
  return RowsAt(configurations);
}

std::set<double> Configurations(const Dataset& data) {
  std::set<double> found;
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    found.insert(data.joint_values(1, i));
  }
  return found;
}

void ExpectDisjoint(const HoldOut& split) {
  for (const double configuration : Configurations(split.validation)) {
    EXPECT_EQ(Configurations(split.train).count(configuration), 0u);
  }
}

TEST(GroupByConfigurationTest, NumbersConfigurationsByFirstRow) {
  EXPECT_EQ(GroupByConfiguration(RowsAt({7, 3, 7, 3, 9, 7})),
            (std::vector<int>{0, 1, 0, 1, 2, 0}));
  EXPECT_TRUE(GroupByConfiguration(RowsAt({})).empty());
}

TEST(HoldOutFractionTest, HoldsOutTheFractionAndKeepsRepeatsTogether) {
  const Dataset data = HundredConfigurations();
  const HoldOut split = HoldOutFraction(data, 0.3, 5);
  EXPECT_EQ(Configurations(split.validation).size(), 30u);
  EXPECT_EQ(Configurations(split.train).size(), 70u);
  EXPECT_EQ(split.train.num_poses() + split.validation.num_poses(),
            data.num_poses());
  ExpectDisjoint(split);
}

TEST(HoldOutFractionTest, KeepsWhatBelongsToARowAndTheOrderOfRows) {
  const HoldOut split = HoldOutFraction(RowsAt({0, 1, 2, 3, 4, 5}), 0.5, 1);
  ASSERT_EQ(split.train.num_poses(), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_EQ(split.train.positions()(0, i), split.train.joint_values(1, i));
    EXPECT_EQ(split.train.sigmas()(2, i), 1e-3);
    if (i > 0) {
      EXPECT_GT(split.train.positions()(0, i),
                split.train.positions()(0, i - 1));
    }
  }
}

TEST(HoldOutFractionTest, DependsOnTheSeedAlone) {
  const Dataset data = HundredConfigurations();
  const auto drawn = [&](std::uint64_t seed) {
    return Configurations(HoldOutFraction(data, 0.3, seed).validation);
  };
  EXPECT_EQ(drawn(1), drawn(1));
  EXPECT_NE(drawn(1), drawn(2));
}

// Each configuration is held out in 30 of 100 draws but for chance: the count
// is binomial with a standard deviation of 4.6, and 5.5 of these to both
// sides leave all 100 inside in all but one case of a hundred thousand.
TEST(HoldOutFractionTest, DrawsEveryConfigurationEquallyOften) {
  const Dataset data = HundredConfigurations();
  std::vector<int> counts(100, 0);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (const double drawn :
         Configurations(HoldOutFraction(data, 0.3, seed).validation)) {
      ++counts[static_cast<int>(drawn)];
    }
  }
  for (const int count : counts) EXPECT_NEAR(count, 30, 25);
}

// Binomial: 300 +- 12 of 600, five of these to both sides.
TEST(HoldOutFractionTest, DrawsEitherOfTwoConfigurationsEquallyOften) {
  const Dataset data = RowsAt({0, 1});
  int first = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    first += static_cast<int>(
        Configurations(HoldOutFraction(data, 0.5, seed).validation).count(0.0));
  }
  EXPECT_NEAR(first, 300, 61);
}

TEST(HoldOutFoldTest, HoldsOutEveryConfigurationOnce) {
  const Dataset data = HundredConfigurations();
  std::multiset<double> all;
  for (int k = 0; k < 7; ++k) {
    const HoldOut split = HoldOutFold(data, 7, k, 3);
    ExpectDisjoint(split);
    const std::set<double> fold = Configurations(split.validation);
    // 100 = 7 * 14 + 2.
    EXPECT_EQ(fold.size(), k < 2 ? 15u : 14u);
    all.insert(fold.begin(), fold.end());
  }
  EXPECT_EQ(all.size(), 100u);
  EXPECT_EQ(std::set<double>(all.begin(), all.end()).size(), 100u);
}

TEST(HoldOutFoldTest, LeavesAPartEmptyWhereNothingIsLeftForIt) {
  const HoldOut split = HoldOutFold(RowsAt({4, 4, 4}), 2, 1, 1);
  EXPECT_EQ(split.validation.num_poses(), 0);
  EXPECT_EQ(split.train.num_poses(), 3);
}

// Eight poses, pose i at joint value i, with a block of every shape: positions
// of all poses; distances of some, out of order, of two targets with whiteners;
// differences; distances of points.
Dataset MixedData() {
  Dataset data = RowsAt({0, 1, 2, 3, 4, 5, 6, 7});
  data.files = {"mixed.csv"};
  for (int i = 0; i < 8; ++i) data.sources.push_back({0, i + 2});
  ObservationBlock distances;
  distances.kind = MeasurementKind::kDistance;
  distances.poses = {5, 0, 5, 2, 7};
  distances.targets = {0, 1, 1, 0, 1};
  distances.references = {3, 1, 4, 1, 5};
  distances.measured = Eigen::MatrixXd(1, 5);
  *testing::Edit(&distances.measured) << 50.0, 51.0, 52.0, 53.0, 54.0;
  distances.sigmas = 1e-3 * distances.measured.map();
  for (int i = 0; i < 5; ++i) {
    distances.whiteners.push_back(Eigen::MatrixXd::Constant(1, 1, 10.0 + i));
  }
  ObservationBlock differences;
  differences.kind = MeasurementKind::kDifference;
  differences.poses = {0, 3, 6};
  differences.seconds = {3, 1, 2};
  differences.measured = Eigen::MatrixXd::Zero(3, 3);
  testing::Edit(&differences.measured)->row(0) << 70.0, 71.0, 72.0;
  differences.sigmas = Eigen::MatrixXd::Ones(3, 3);
  ObservationBlock bars;
  bars.kind = MeasurementKind::kPointDistance;
  bars.references = {0, 1};
  bars.seconds = {1, 2};
  bars.measured = Eigen::MatrixXd::Constant(1, 2, 0.5);
  bars.sigmas = Eigen::MatrixXd::Constant(1, 2, 1e-5);
  data.blocks.insert(data.blocks.end(), {distances, differences, bars});
  return data;
}

TEST(SelectPosesTest, TakesAllThatWasObservedAtThem) {
  const Dataset data = MixedData();
  const Dataset selected = SelectPoses(data, {7, 5, 3, 0});
  EXPECT_EQ(selected.name, data.name);
  EXPECT_EQ(selected.files, data.files);
  EXPECT_EQ(selected.joint_values.row(1), Eigen::RowVector4d(7, 5, 3, 0));
  ASSERT_EQ(selected.sources.size(), 4u);
  EXPECT_EQ(selected.sources[1].line, 7);
  ASSERT_EQ(selected.blocks.size(), 4u);
  const ObservationBlock& positions = selected.blocks[0];
  EXPECT_TRUE(positions.poses.empty());
  EXPECT_EQ(positions.measured.row(0), Eigen::RowVector4d(7, 5, 3, 0));
  const ObservationBlock& distances = selected.blocks[1];
  EXPECT_EQ(distances.poses, (std::vector<int>{1, 3, 1, 0}));
  EXPECT_EQ(distances.targets, (std::vector<int>{0, 1, 1, 1}));
  EXPECT_EQ(distances.references, (std::vector<int>{3, 1, 4, 5}));
  EXPECT_EQ(distances.measured, Eigen::RowVector4d(50, 51, 52, 54));
  EXPECT_EQ(distances.sigmas, 1e-3 * distances.measured.map());
  ASSERT_EQ(distances.whiteners.size(), 4u);
  EXPECT_EQ(distances.whiteners[3](0, 0), 14.0);
  // Pose 3 without 1 and pose 2 without 6 make no difference.
  const ObservationBlock& differences = selected.blocks[2];
  EXPECT_EQ(differences.poses, (std::vector<int>{3}));
  EXPECT_EQ(differences.seconds, (std::vector<int>{2}));
  EXPECT_EQ(differences.measured(0, 0), 70.0);
  EXPECT_EQ(selected.blocks[3].size(), 2);
  EXPECT_EQ(selected.blocks[3].seconds, data.blocks[3].seconds);
}

TEST(SelectPosesTest, OfAllPosesIsTheDataSet) {
  const Dataset data = MixedData();
  const Dataset same = SelectPoses(data, {0, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(same.joint_values, data.joint_values);
  ASSERT_EQ(same.blocks.size(), data.blocks.size());
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    EXPECT_EQ(same.blocks[b].kind, data.blocks[b].kind);
    EXPECT_EQ(same.blocks[b].poses, data.blocks[b].poses);
    EXPECT_EQ(same.blocks[b].targets, data.blocks[b].targets);
    EXPECT_EQ(same.blocks[b].references, data.blocks[b].references);
    EXPECT_EQ(same.blocks[b].seconds, data.blocks[b].seconds);
    EXPECT_EQ(same.blocks[b].measured, data.blocks[b].measured);
    EXPECT_EQ(same.blocks[b].sigmas, data.blocks[b].sigmas);
  }
}

TEST(SelectPosesTest, OfNoPosesLeavesDistancesOfPointsAlone) {
  const Dataset none = SelectPoses(MixedData(), {});
  EXPECT_EQ(none.num_poses(), 0);
  EXPECT_EQ(none.num_observations(), 2);
  EXPECT_TRUE(none.Has(MeasurementKind::kPointDistance));
}

// Where observation i is of pose i, its second pose may still be left out.
TEST(SelectPosesTest, DifferencesWithoutAListOfPosesNeedBothToo) {
  Dataset data = RowsAt({0, 1, 2, 3});
  data.blocks[0].kind = MeasurementKind::kDifference;
  data.blocks[0].seconds = {1, 2, 3, 0};
  const Dataset selected = SelectPoses(data, {3, 2, 0});
  ASSERT_EQ(selected.blocks[0].size(), 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const int pose = selected.blocks[0].pose(i);
    const int second = selected.blocks[0].seconds[i];
    EXPECT_EQ(selected.joint_values(1, pose),
              selected.blocks[0].measured(0, i));
    EXPECT_EQ(selected.joint_values(1, second),
              selected.blocks[0].measured(0, i) == 3.0 ? 0.0 : 3.0);
  }
}

TEST(GroupByConfigurationTest, JoinsThePosesOfDifferences) {
  // 0 - 3, 3 - 1 and 6 - 2; pose 4 repeats pose 1.
  Dataset data = MixedData();
  testing::Edit(&data.joint_values)->col(4) = data.joint_values.col(1);
  EXPECT_EQ(GroupByConfiguration(data),
            (std::vector<int>{0, 0, 1, 0, 0, 2, 1, 3}));
}

TEST(HoldOutTest, DifferencesStayWholeAndDistancesOfPointsAreFitted) {
  const Dataset data = MixedData();
  const Eigen::Index differences = data.blocks[2].size();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    for (const HoldOut& split :
         {HoldOutFraction(data, 0.4, seed), HoldOutFold(data, 2, 0, seed)}) {
      EXPECT_EQ(split.train.num_poses() + split.validation.num_poses(), 8);
      EXPECT_GT(split.validation.num_poses(), 0);
      EXPECT_EQ(
          split.train.blocks[2].size() + split.validation.blocks[2].size(),
          differences);
      // Nothing is lost and nothing is there twice.
      EXPECT_EQ(
          split.train.num_observations() + split.validation.num_observations(),
          data.num_observations());
      EXPECT_EQ(split.train.blocks[3].size(), 2);
      EXPECT_FALSE(split.validation.Has(MeasurementKind::kPointDistance));
      ExpectDisjoint(split);
    }
  }
}

}  // namespace
}  // namespace alidade::internal
