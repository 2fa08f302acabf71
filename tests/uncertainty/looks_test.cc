#include "src/uncertainty/looks.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "src/model/joint_draw.h"
#include "tests/support/edit.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

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

// Six configurations of the RV-2AJ, the first measured once, the next twice,
// the next three times, and so on again, with residuals of known sizes.
class TakeLooksTest : public ::testing::Test {
 protected:
  TakeLooksTest() {
    const Eigen::MatrixXd drawn = DrawJointValues(model_.nominal(), 6, 3);
    Eigen::MatrixXd joints(5, 12);
    for (int k = 0; k < 12; ++k) joints.col(k) = drawn.col(kConfiguration[k]);
    points_ = model_.Predict(values_, joints);
    residuals_.resize(3, 12);
    for (int k = 0; k < 12; ++k) {
      residuals_.col(k) << 0.1 * k, 0.3 - 0.01 * k * k, (k % 2) * 0.2;
    }
    joints_ = joints;
  }

  Looks Take() {
    data_ = MakePositions(joints_, points_ - kSigma * residuals_, kSigma);
    return TakeLooks({model_, data_, columns_, priors_, losses_, values_});
  }

  static constexpr double kSigma = 1e-4;
  static constexpr int kConfiguration[12] = {0, 1, 1, 2, 2, 2,
                                             3, 4, 4, 5, 5, 5};
  const MeasurementModel model_{testing::Rv2ajFlange()};
  const Eigen::VectorXd values_ = model_.NominalValues();
  const std::vector<int> columns_ = {0, 1, 2};
  const Eigen::VectorXd priors_;
  std::vector<RobustLoss> losses_;
  Eigen::MatrixXd joints_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd residuals_;
  Dataset data_;
};

TEST_F(TakeLooksTest, RepeatsAreOneLookOfTheirMean) {
  const Looks looks = Take();
  EXPECT_FALSE(looks.is_sample);
  EXPECT_EQ(looks.counts, (std::vector<int>{1, 2, 3, 1, 2, 3}));
  ASSERT_EQ(looks.residuals.size(), 18);
  double squares = 0.0;
  int k = 0;
  for (int look = 0; look < 6; ++look) {
    const int count = looks.counts[look];
    const Eigen::MatrixXd same = residuals_.middleCols(k, count);
    const Eigen::Vector3d mean = same.rowwise().mean();
    // Rounding of positions of half a metre, over sigma.
    EXPECT_LE((looks.residuals.segment<3>(3 * look) - mean).norm(), 1e-11);
    EXPECT_EQ(looks.data.blocks[0].pose(look), k);
    squares += (same.colwise() - mean).squaredNorm();
    k += count;
  }
  EXPECT_NEAR(looks.repeat_squares[kLengths], squares, 1e-10);
  // Three rows of one, two, one and two degrees of freedom.
  EXPECT_NEAR(looks.repeat_freedom[kLengths], 18.0, 1e-12);
  EXPECT_EQ(looks.repeat_freedom[kRotations], 0.0);
}

// Small residuals weigh the most.
TEST_F(TakeLooksTest, WhatTheLossHasGivenUpIsNotLookedAt) {
  losses_ = TunedLosses(LossKind::kHuber);
  EXPECT_EQ(Take().counts, (std::vector<int>{1, 2, 3, 1, 2, 3}));
  residuals_.col(4).setConstant(50.0);
  residuals_.col(6).setConstant(50.0);
  const Looks looks = Take();
  EXPECT_EQ(looks.counts, (std::vector<int>{1, 2, 2, 2, 3}));
  EXPECT_NEAR(looks.repeat_freedom[kLengths], 15.0, 1e-12);
}

// Nor what was not measured.
TEST_F(TakeLooksTest, ObservationsWithoutARowAreNone) {
  Take();
  testing::Edit(&data_.sigmas())
      ->col(1)
      .setConstant(std::numeric_limits<double>::infinity());
  const Looks looks =
      TakeLooks({model_, data_, columns_, priors_, losses_, values_});
  EXPECT_EQ(looks.counts, (std::vector<int>{1, 1, 3, 1, 2, 3}));
}

TEST(LooksTest, ASampleIsOfWholeConfigurations) {
  constexpr int kRepeats = 4;
  const MeasurementModel model(testing::Rv2ajFlange());
  const Eigen::MatrixXd drawn = DrawJointValues(model.nominal(), 2000, 3);
  Eigen::MatrixXd joints(5, kRepeats * drawn.cols());
  for (Eigen::Index i = 0; i < joints.cols(); ++i) {
    joints.col(i) = drawn.col(i / kRepeats);
  }
  const Dataset data =
      MakePositions(joints, Eigen::Matrix3Xd::Zero(3, joints.cols()), 1e-4);
  const std::vector<int> columns =
      testing::FlangeFreeColumns(ParameterLayout(5));
  const Eigen::VectorXd no_priors;
  const std::vector<RobustLoss> losses;
  const Eigen::VectorXd values = model.NominalValues();
  const Looks looks =
      TakeLooks({model, data, columns, no_priors, losses, values});
  EXPECT_TRUE(looks.is_sample);
  // 5000 of 8000 poses, four of each configuration.
  EXPECT_EQ(looks.counts, std::vector<int>(1250, kRepeats));
  EXPECT_EQ(looks.repeat_freedom[kLengths], 3.0 * 1250 * (kRepeats - 1));
}

}  // namespace
}  // namespace alidade::internal
