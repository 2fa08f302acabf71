#include "src/calibration/outlier_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/matrix_errors.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::outlier_pattern_test {
namespace {

constexpr int kPoses = 200;

Dataset DataAt(const Eigen::MatrixXd& q) {
  return MakePositions(q, Eigen::Matrix3Xd::Zero(3, q.cols()).eval(), 1e-4);
}

// Rejected are the poses of the largest `sizes`.
std::vector<Outlier> LargestOf(const std::vector<double>& sizes, int count) {
  std::vector<int> order(sizes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return sizes[a] > sizes[b]; });
  std::vector<Outlier> outliers(count);
  for (int k = 0; k < count; ++k) {
    outliers[k].label.pose = order[k];
    outliers[k].weight = 0.0;
  }
  return outliers;
}

class OutlierPatternTest : public ::testing::Test {
 protected:
  // Of each pose.
  template <typename Size>
  std::vector<double> SizesBy(const Size& size) const {
    std::vector<double> sizes;
    for (Eigen::Index k = 0; k < q_.cols(); ++k) {
      sizes.push_back(size(Eigen::VectorXd(q_.col(k))));
    }
    return sizes;
  }

  Arm arm_ = testing::Rv2ajFlange();
  Eigen::MatrixXd q_ = DrawJointValues(arm_, kPoses, 11);
  Dataset data_ = DataAt(q_);
};

TEST_F(OutlierPatternTest, MomentThatRejectedPosesShareIsNamed) {
  const std::vector<double> moments = SizesBy([&](const Eigen::VectorXd& q) {
    const auto frames = testing::RigidFramesOf(arm_, q.data());
    return std::abs(
        static_cast<double>(testing::MatrixMoment(arm_, frames, 1, 0.0L).z()));
  });
  EXPECT_EQ(PatternOf(arm_, data_, LargestOf(moments, 15)),
            "the gravity moment of joint 2");
}

TEST_F(OutlierPatternTest, JointValueThatRejectedPosesShareIsNamed) {
  const auto of_joint = [](int j) {
    return [j](const Eigen::VectorXd& q) { return q[j]; };
  };
  EXPECT_EQ(PatternOf(arm_, data_, LargestOf(SizesBy(of_joint(0)), 12)),
            "the value of joint 1");
  EXPECT_EQ(PatternOf(arm_, data_, LargestOf(SizesBy(of_joint(4)), 12)),
            "the value of joint 5");
}

TEST_F(OutlierPatternTest, ChanceIsNoPattern) {
  Random random(12);
  int named = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const std::vector<double> sizes =
        SizesBy([&](const Eigen::VectorXd&) { return random.Uniform(); });
    if (!PatternOf(arm_, data_, LargestOf(sizes, 15)).empty()) ++named;
  }
  // One in ten thousand.
  EXPECT_EQ(named, 0);
}

TEST_F(OutlierPatternTest, FewOrHardlyRejectedOnesSayNothing) {
  const std::vector<double> values =
      SizesBy([](const Eigen::VectorXd& q) { return q[0]; });
  EXPECT_EQ(PatternOf(arm_, data_, LargestOf(values, 4)), "");
  std::vector<Outlier> kept = LargestOf(values, 12);
  for (Outlier& outlier : kept) outlier.weight = 0.9;
  EXPECT_EQ(PatternOf(arm_, data_, kept), "");
  // Of no pose, as distances between points are.
  for (Outlier& outlier : kept) {
    outlier.weight = 0.0;
    outlier.label.pose = -1;
  }
  EXPECT_EQ(PatternOf(arm_, data_, kept), "");
}

}  // namespace
}  // namespace alidade::internal::outlier_pattern_test
