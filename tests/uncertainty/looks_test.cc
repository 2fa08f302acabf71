#include "src/uncertainty/looks.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <vector>

namespace alidade::internal {
namespace {

// Poses whose second joint has the values 0 to 63, in no order, each visited
// twice; the first joint hardly moves, but is as wide for its range.
Looks LooksAlongASecondJoint() {
  Looks looks;
  Eigen::MatrixXd joints(2, 128);
  for (int i = 0; i < 128; ++i) {
    const int place = (i % 64) * 37 % 64;
    joints.col(i) << 1e-3 * (place % 2), place;
    looks.configurations.push_back(i % 64);
  }
  looks.data.joint_values = joints;
  return looks;
}

TEST(BlocksOfNeighboursTest, AreAsManyAsParametersAskForAndEven) {
  // Eight blocks are the power of two that is no less than twice four. The
  // widest joint is cut first: the even places from the odd ones.
  const Looks looks = LooksAlongASecondJoint();
  const std::vector<int> blocks = BlocksOfNeighbours(looks, 4);
  ASSERT_EQ(blocks.size(), 64U);
  std::map<int, std::vector<double>> places;
  for (int i = 0; i < 64; ++i) {
    places[blocks[i]].push_back(looks.data.joint_values(1, i));
  }
  ASSERT_EQ(places.size(), 8U);
  for (auto& [block, list] : places) {
    EXPECT_GE(block, 0);
    EXPECT_LT(block, 8);
    ASSERT_EQ(list.size(), 8U);
    const auto [least, most] = std::minmax_element(list.begin(), list.end());
    // Eight of one parity in a row.
    EXPECT_EQ(*most - *least, 14.0) << block;
  }
}

TEST(BlocksOfNeighboursTest, AreNoneOfFewerThanFourConfigurations) {
  const Looks looks = LooksAlongASecondJoint();
  EXPECT_EQ(BlocksOfNeighbours(looks, 8).size(), 64U);
  EXPECT_TRUE(BlocksOfNeighbours(looks, 9).empty());
}

}  // namespace
}  // namespace alidade::internal
