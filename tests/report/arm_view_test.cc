#include "src/report/arm_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "tests/report/report_test_util.h"
#include "tests/report/well_formed.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using nlohmann::json;

// Corners are rounded nowhere: the tolerance is that of sines of right angles.
constexpr double kRounding = 1e-12;

EvaluatedSet SetOf(Eigen::MatrixXd joint_values) {
  EvaluatedSet set;
  set.joint_dimensions.assign(static_cast<std::size_t>(joint_values.rows()),
                              Dimension::kAngle);
  set.joint_values = std::move(joint_values);
  return set;
}

TEST(ArmViewTest, ArmIsDrawnThroughItsJoints) {
  Arm arm = testing::Rv2ajFlange();
  arm.instrument_from_base.translation() << 1.0, 2.0, 3.0;
  // Straight up, and with the elbow bent by a right angle.
  Eigen::MatrixXd joints = Eigen::MatrixXd::Zero(5, 2);
  joints(2, 1) = 0.5 * kPi;
  const ArmPicture picture = PictureOf(arm, SetOf(joints));
  EXPECT_EQ(picture.poses, (std::vector<int>{1, 2}));
  // Base, shoulder, elbow, wrist, flange: 300, 250, 160 and 72 mm.
  const Eigen::Matrix3Xd& up = picture.lines[0];
  ASSERT_EQ(up.cols(), 5);
  const double heights[] = {0.0, 0.3, 0.55, 0.71, 0.782};
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(up(0, i), 1.0, kRounding);
    EXPECT_NEAR(up(1, i), 2.0, kRounding);
    EXPECT_NEAR(up(2, i), 3.0 + heights[i], kRounding);
  }
  const Eigen::Matrix3Xd& bent = picture.lines[1];
  ASSERT_EQ(bent.cols(), 5);
  EXPECT_NEAR(bent(2, 2), 3.55, kRounding);
  EXPECT_NEAR(bent(2, 4), 3.55, kRounding);  // level with the elbow
  EXPECT_NEAR((bent.col(4) - bent.col(2)).norm(), 0.232, kRounding);
}

TEST(ArmViewTest, NotTooManyPosesAreDrawn) {
  const ArmPicture picture =
      PictureOf(testing::Rv2ajFlange(), SetOf(Eigen::MatrixXd::Zero(5, 200)));
  EXPECT_LE(picture.poses.size(), 60U);
  EXPECT_GE(picture.poses.size(), 30U);
  EXPECT_EQ(picture.poses.front(), 1);
  for (std::size_t i = 1; i < picture.poses.size(); ++i) {
    EXPECT_LT(picture.poses[i - 1], picture.poses[i]);
  }
}

TEST(ArmViewTest, OtherSetsHaveNoPicture) {
  EXPECT_TRUE(PictureOf(testing::Rv2ajFlange(), {}).poses.empty());
  EXPECT_TRUE(
      PictureOf(testing::Rv2ajFlange(), SetOf(Eigen::MatrixXd::Zero(1, 3)))
          .poses.empty());
  EvaluatedSet prismatic = SetOf(Eigen::MatrixXd::Zero(5, 3));
  prismatic.joint_dimensions[4] = Dimension::kLength;
  EXPECT_TRUE(PictureOf(testing::Rv2ajFlange(), prismatic).poses.empty());
  // A distance of reference points has neither pose nor joint values.
  EXPECT_TRUE(PictureOf(testing::Rv2ajFlange(),
                        SetOf(Eigen::MatrixXd::Constant(5, 1, std::nan(""))))
                  .poses.empty());
  EXPECT_EQ(ArmViewJson(CalibrationResult()), "");
}

TEST(ArmViewTest, PlacesAndErrorsAreInTheFrameOfTheBase) {
  CalibrationResult result = testing::MakeResult();
  // A quarter turn about z, and 0.25 m up.
  result.arm.instrument_from_base.linear() =
      Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ()).matrix();
  result.arm.instrument_from_base.translation() << 0.0, 0.0, 0.25;
  const json view = json::parse(ArmViewJson(result));
  EXPECT_TRUE(view["lines"].empty());  // of another arm
  ASSERT_EQ(view["places"].size(), 5U);
  const json& place = view["places"][0];
  EXPECT_EQ(place[0], 1);
  // Measured at (300, 0, 215) mm.
  EXPECT_NEAR(place[1][1].get<double>(), -300.0, 1e-3);
  EXPECT_NEAR(place[1][2].get<double>(), -35.0, 1e-3);
  // 5.21 mm times (0.6, 0, -0.8).
  EXPECT_NEAR(place[2][1].get<double>(), -3.126, 1e-3);
  EXPECT_NEAR(place[2][2].get<double>(), -4.168, 1e-3);
}

// The longest error of a state is a tenth of the drawing at most, whatever the
// other is.
TEST(ArmViewTest, BeforeAndAfterHaveScalesOfTheirOwn) {
  ArmView view;
  // 1000 mm wide.
  for (int i = 0; i <= 10; ++i) {
    view.places.push_back({i + 1,
                           {100.0 * i, 0.0, 0.0},
                           {0.0, 0.4 * (i + 0.5), 0.0},
                           {0.0, 0.0, 0.0012 * (i + 0.5)}});
  }
  const json data = json::parse(ArmViewJson(view));
  EXPECT_EQ(data["factors"]["before"], 20.0);   // 23.8 or less
  EXPECT_EQ(data["factors"]["after"], 5000.0);  // 7937 or less
  EXPECT_EQ(data["shades"]["before"],
            (std::vector<int>{0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}));
  EXPECT_EQ(data["shades"]["after"], data["shades"]["before"]);
  view.places = {{1, {100.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
  EXPECT_EQ(ErrorFactor(view, &ViewPlace::before), 1.0);
}

TEST(ArmViewTest, FigureIsWholeWithoutScript) {
  const CalibrationResult result = testing::MakeResult();
  const std::string html = ArmViewFigure(ViewOf(result), "<The arm>");
  EXPECT_EQ(WhatIsMalformed(html), "");
  EXPECT_NE(html.find("&lt;The arm&gt;"), std::string::npos);
  for (const char* layer : {"before-4", "after-4", "places", "axes", "scale"}) {
    EXPECT_NE(html.find("data-layer=\"" + std::string(layer) + "\""),
              std::string::npos)
        << layer;
  }
  EXPECT_EQ(ArmViewFigure({}, "nothing"), "");
}

}  // namespace
}  // namespace alidade::internal
