#include "src/planning/link_capsules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;

// The least distance between points of both segments, `steps` parts each: at
// most half a step of each more than the true one.
double SampledDistance(const Segment& a, const Segment& b, int steps) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const Vector3d p = a.from + (a.to - a.from) * i / steps;
    for (int k = 0; k <= steps; ++k) {
      const Vector3d q = b.from + (b.to - b.from) * k / steps;
      least = std::min(least, (p - q).norm());
    }
  }
  return least;
}

void ExpectAsSampled(const Segment& a, const Segment& b) {
  constexpr int kSteps = 80;
  constexpr double kRounding = 1e-12;
  const double step =
      ((a.to - a.from).norm() + (b.to - b.from).norm()) / kSteps;
  const double sampled = SampledDistance(a, b, kSteps);
  const double distance = SegmentDistance(a, b);
  EXPECT_LE(distance, sampled + kRounding);
  EXPECT_GE(distance, sampled - 0.5 * step - kRounding);
  EXPECT_NEAR(SegmentDistance(b, a), distance, kRounding);
}

TEST(SegmentDistanceTest, IsThatOfSampledPoints) {
  Random random(1, 0);
  const auto point = [&random] {
    return Vector3d(random.Normal(), random.Normal(), random.Normal());
  };
  for (int i = 0; i < 30; ++i) {
    const Segment a = {point(), point()};
    ExpectAsSampled(a, {point(), point()});
    // Near and crossing ones, parallel ones, and points.
    const Vector3d on = a.from + random.Uniform() * (a.to - a.from);
    const Vector3d way = point();
    ExpectAsSampled(a, {on - 0.3 * way, on + 0.7 * way});
    const Vector3d beside = 0.2 * point();
    ExpectAsSampled(a, {a.from + beside, a.to + beside});
    ExpectAsSampled(a, {a.to + beside, 2.0 * a.to - a.from + beside});
    const Vector3d alone = point();
    ExpectAsSampled(a, {alone, alone});
  }
}

TEST(SegmentDistanceTest, CrossingSegmentsTouch) {
  EXPECT_DOUBLE_EQ(SegmentDistance({{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}},
                                   {{0.0, -1.0, 0.25}, {0.0, 1.0, 0.25}}),
                   0.25);
}

// RV-2AJ: base 300 mm, upper arm 250, forearm 160, flange 72. With the elbow
// 10 deg from fully folded, the flange is beside the upper arm and ends beside
// the base.
TEST(LinkCapsulesTest, FoldedArmIsNamed) {
  using ::testing::AllOf;
  using ::testing::DoubleNear;
  using ::testing::ElementsAre;
  using ::testing::Field;
  constexpr double kRounding = 1e-12;
  Eigen::MatrixXd poses = Eigen::MatrixXd::Zero(5, 3);
  poses(2, 1) = 170.0 * kDegree;
  const LinkCaution caution =
      FindLinkOverlaps(testing::Rv2ajFlange(), poses, 0.03);
  EXPECT_DOUBLE_EQ(caution.radius, 0.03);
  const double beside = std::sin(10.0 * kDegree);
  const double to_base =
      std::hypot(0.232 * beside, 0.25 - 0.232 * std::cos(10.0 * kDegree));
  const auto overlap = [&](const char* first, double distance) {
    return AllOf(
        Field(&LinkOverlap::pose, 2), Field(&LinkOverlap::first, first),
        Field(&LinkOverlap::second, "link 4"),
        Field(&LinkOverlap::overlap, DoubleNear(0.06 - distance, kRounding)));
  };
  EXPECT_THAT(caution.overlaps, ElementsAre(overlap("base", to_base),
                                            overlap("link 2", 0.16 * beside)));
}

// The flange hangs on the upper arm by the forearm of 160 mm: capsules of more
// than half of it overlap there at any pose.
TEST(LinkCapsulesTest, LinksThatHangTogetherAreLeftOut) {
  const Arm arm = testing::Rv2ajFlange();
  Eigen::MatrixXd folded = Eigen::MatrixXd::Zero(5, 1);
  folded(2, 0) = 170.0 * kDegree;
  const auto has_upper_arm = [&](double radius) {
    const LinkCaution caution = FindLinkOverlaps(arm, folded, radius);
    return std::any_of(caution.overlaps.begin(), caution.overlaps.end(),
                       [](const LinkOverlap& each) {
                         return each.first == "link 2" &&
                                each.second == "link 4";
                       });
  };
  EXPECT_TRUE(has_upper_arm(0.079));
  EXPECT_FALSE(has_upper_arm(0.081));
  EXPECT_FALSE(FindLinkOverlaps(arm, folded, 0.081).overlaps.empty());
}

TEST(LinkCapsulesTest, LooksOnlyWhereLinksAreApart) {
  const Arm arm = testing::Rv2ajFlange();
  const Eigen::MatrixXd up = Eigen::MatrixXd::Zero(5, 1);
  EXPECT_TRUE(FindLinkOverlaps(arm, up, 0.03).overlaps.empty());
  EXPECT_TRUE(FindLinkOverlaps(arm, up, 0.0).overlaps.empty());
  EXPECT_EQ(FindLinkOverlaps(arm, up, 0.0).radius, 0.0);
  // All lengths of the chain are 782 mm.
  EXPECT_NEAR(TypicalLinkRadius(arm), 0.0391, 1e-6);
  // Capsules thicker than the links between them are long say nothing.
  EXPECT_TRUE(FindLinkOverlaps(arm, up, 0.5).overlaps.empty());
}

}  // namespace
}  // namespace alidade::internal
