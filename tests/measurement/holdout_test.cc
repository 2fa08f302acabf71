#include "alidade/measurement/holdout.h"

#include <gtest/gtest.h>

#include <set>

namespace alidade {
namespace {

// Row i stands at configuration configurations[i] and measures x = i.
Dataset RowsAt(const std::vector<double>& configurations) {
  const auto count = static_cast<Eigen::Index>(configurations.size());
  Dataset data;
  data.name = "rows";
  data.joint_values.resize(2, count);
  data.positions().setZero(3, count);
  data.sigmas().setConstant(3, count, 1e-3);
  for (Eigen::Index i = 0; i < count; ++i) {
    data.joint_values.col(i) << 0.5, configurations[i];
    data.positions()(0, i) = static_cast<double>(i);
  }
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
  for (const double configuration : Configurations(split.heldout)) {
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
  EXPECT_EQ(Configurations(split.heldout).size(), 30u);
  EXPECT_EQ(Configurations(split.train).size(), 70u);
  EXPECT_EQ(split.train.num_poses() + split.heldout.num_poses(),
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
    return Configurations(HoldOutFraction(data, 0.3, seed).heldout);
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
         Configurations(HoldOutFraction(data, 0.3, seed).heldout)) {
      ++counts[static_cast<int>(drawn)];
    }
  }
  for (const int count : counts) EXPECT_NEAR(count, 30, 25);
}

TEST(HoldOutFoldTest, HoldsOutEveryConfigurationOnce) {
  const Dataset data = HundredConfigurations();
  std::multiset<double> all;
  for (int k = 0; k < 7; ++k) {
    const HoldOut split = HoldOutFold(data, 7, k, 3);
    ExpectDisjoint(split);
    const std::set<double> fold = Configurations(split.heldout);
    // 100 = 7 * 14 + 2.
    EXPECT_EQ(fold.size(), k < 2 ? 15u : 14u);
    all.insert(fold.begin(), fold.end());
  }
  EXPECT_EQ(all.size(), 100u);
  EXPECT_EQ(std::set<double>(all.begin(), all.end()).size(), 100u);
}

TEST(HoldOutFoldTest, LeavesAPartEmptyWhereNothingIsLeftForIt) {
  const HoldOut split = HoldOutFold(RowsAt({4, 4, 4}), 2, 1, 1);
  EXPECT_EQ(split.heldout.num_poses(), 0);
  EXPECT_EQ(split.train.num_poses(), 3);
}

}  // namespace
}  // namespace alidade
