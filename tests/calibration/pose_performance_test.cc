// Pose accuracy and repeatability against numbers worked out by hand.

#include "src/calibration/pose_performance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "alidade/units.h"

namespace alidade::internal::pose_performance_test {
namespace {

// Attained less commanded, in mm; residuals are the other way round.
SharedMatrix Residuals(const std::vector<Eigen::Vector3d>& attained,
                       double unit) {
  Eigen::MatrixXd all(3, static_cast<Eigen::Index>(attained.size()));
  for (Eigen::Index i = 0; i < all.cols(); ++i)
    all.col(i) = -unit * attained[i];
  return all;
}

// Configuration 1 at rows 1, 3 and 4, configuration 2 once.
EvaluatedSet ThreeAndOne() {
  EvaluatedSet set;
  Eigen::MatrixXd joints(2, 4);
  joints << 0.1, 0.2, 0.1, 0.1,  //
      0.5, 0.5, 0.5, 0.5;
  set.joint_values = joints;
  set.residual_before =
      Residuals({{3, 4, 0}, {9, 9, 9}, {3, 4, 0}, {3, 4, 0}}, kMillimetre);
  set.residual_after =
      Residuals({{0, 0, 0}, {9, 9, 9}, {2, 0, 0}, {1, 3, 0}}, kMillimetre);
  set.positions = Eigen::MatrixXd::Zero(3, 4);
  return set;
}

TEST(PosePerformanceTest, IsThatOfTheStandard) {
  const auto summary = MeasurePosePerformance("training", ThreeAndOne(), {});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->configurations, 1);
  EXPECT_EQ(summary->fewest, 3);
  ASSERT_EQ(summary->each.size(), 1u);
  const PosePerformance& one = summary->each[0];
  EXPECT_EQ(one.pose, 0);
  EXPECT_EQ(one.n, 3);
  EXPECT_NEAR(one.before, 5e-3, 1e-15);
  // The barycentre is at 1, 1, 0, its distances are sqrt 2, sqrt 2 and 2.
  EXPECT_NEAR(one.accuracy, std::sqrt(2.0) * 1e-3, 1e-15);
  EXPECT_NEAR(one.mean_distance, 1.6094757e-3, 1e-10);
  EXPECT_NEAR(one.distance_std, 0.3382039e-3, 1e-10);
  EXPECT_NEAR(one.repeatability(), 2.6240875e-3, 1e-9);
  EXPECT_TRUE(std::isnan(one.rotation_accuracy[0]));
  EXPECT_EQ(summary->repeatability.max, one.repeatability());
}

TEST(PosePerformanceTest, OrientationsHaveTheirOwn) {
  EvaluatedSet set = ThreeAndOne();
  set.rotation_residual_before = Eigen::MatrixXd::Zero(3, 4);
  set.rotation_residual_after =
      Residuals({{1, 0, 0}, {9, 9, 9}, {2, 0, 5}, {3, 0, 5}}, 1e-3);
  for (int i = 0; i < 4; ++i) {
    set.labels.push_back({"pose", i, "", "", true, true});
  }
  const auto summary = MeasurePosePerformance("training", set, {});
  ASSERT_TRUE(summary);
  const PosePerformance& one = summary->each.at(0);
  EXPECT_NEAR(one.rotation_accuracy[0], 2e-3, 1e-15);
  EXPECT_NEAR(one.rotation_accuracy[2], 10e-3 / 3.0, 1e-15);
  EXPECT_NEAR(one.rotation_repeatability[0], 3e-3, 1e-15);
  EXPECT_NEAR(one.rotation_repeatability[2], 3e-3 * 5.0 / std::sqrt(3.0),
              1e-12);
}

TEST(PosePerformanceTest, TargetsAndPartsOfPositionsAreNotRepeats) {
  EvaluatedSet set = ThreeAndOne();
  for (int i = 0; i < 4; ++i) {
    set.labels.push_back({"position", i, "b", "", true, false});
  }
  EXPECT_EQ(MeasurePosePerformance("training", set, {})->each.at(0).n, 3);
  set.labels[0].target = "a";
  EXPECT_FALSE(MeasurePosePerformance("training", set, {}));
  set.labels[0].target = "b";
  Eigen::MatrixXd positions = set.positions.map();
  positions(2, 3) = std::nan("");
  set.positions = positions;
  EXPECT_FALSE(MeasurePosePerformance("training", set, {}));
}

// Of two, RP would be the half of their distance, whatever the arm does.
TEST(PosePerformanceTest, RejectedObservationsAreNotRepeats) {
  const EvaluatedSet set = ThreeAndOne();
  Outlier outlier;
  outlier.observation = 2;
  outlier.weight = 0.9;
  EXPECT_TRUE(MeasurePosePerformance("training", set, {outlier}));
  outlier.weight = 0.0;
  EXPECT_FALSE(MeasurePosePerformance("training", set, {outlier}));
}

}  // namespace
}  // namespace alidade::internal::pose_performance_test
