#include "src/job/report_page.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"

namespace alidade::internal {
namespace {

// Corners are rounded nowhere: the tolerance is that of sines of right angles.
constexpr double kRounding = 1e-12;

Arm Rv2aj() {
  return LoadArm(std::string(ALIDADE_SOURCE_DIR) +
                 "/configs/robots/rv2aj_flange.yaml");
}

TEST(ReportPageTest, ArmIsDrawnThroughItsJoints) {
  Arm arm = Rv2aj();
  arm.instrument_from_base.translation() << 1.0, 2.0, 3.0;
  // Straight up, and with the elbow bent by a right angle.
  const auto picture =
      PictureOf(arm, WholeText("pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n"
                               "4,0,0,0,0,0\n7,0,0,90,0,0\n"));
  ASSERT_TRUE(picture.has_value());
  EXPECT_EQ(picture->poses, (std::vector<int>{4, 7}));
  EXPECT_EQ(picture->instrument_from_base(1, 3), 2.0);
  // Base, shoulder, elbow, wrist, flange: 300, 250, 160 and 72 mm.
  const Eigen::Matrix3Xd& up = picture->lines[0];
  ASSERT_EQ(up.cols(), 5);
  const double heights[] = {0.0, 0.3, 0.55, 0.71, 0.782};
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(up(0, i), 1.0, kRounding);
    EXPECT_NEAR(up(1, i), 2.0, kRounding);
    EXPECT_NEAR(up(2, i), 3.0 + heights[i], kRounding);
  }
  const Eigen::Matrix3Xd& bent = picture->lines[1];
  ASSERT_EQ(bent.cols(), 5);
  EXPECT_NEAR(bent(2, 2), 3.55, kRounding);
  EXPECT_NEAR(bent(2, 4), 3.55, kRounding);  // level with the elbow
  EXPECT_NEAR((bent.col(4) - bent.col(2)).norm(), 0.232, kRounding);
}

TEST(ReportPageTest, OneRowAPoseAndNotTooMany) {
  std::string csv = "pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n";
  for (int pose = 1; pose <= 200; ++pose) {
    const std::string row = std::to_string(pose) + ",1,2,3,4,5\n";
    csv += row + row;  // two observations
  }
  const auto picture = PictureOf(Rv2aj(), WholeText(csv));
  ASSERT_TRUE(picture.has_value());
  EXPECT_LE(picture->poses.size(), 60U);
  EXPECT_GE(picture->poses.size(), 30U);
  EXPECT_EQ(picture->poses.front(), 1);
  for (std::size_t i = 1; i < picture->poses.size(); ++i) {
    EXPECT_LT(picture->poses[i - 1], picture->poses[i]);
  }
}

TEST(ReportPageTest, OtherTablesHaveNoPicture) {
  EXPECT_FALSE(PictureOf(Rv2aj(), {}).has_value());
  EXPECT_FALSE(PictureOf(Rv2aj(), WholeText("pose,q1_deg\n1,0\n")).has_value());
  EXPECT_FALSE(
      PictureOf(
          Rv2aj(),
          WholeText("pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_mm\n1,0,0,0,0,0\n"))
          .has_value());
  // A distance of reference points has neither pose nor joint values.
  EXPECT_FALSE(
      PictureOf(Rv2aj(),
                WholeText("pose,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg\n,,,,,\n"))
          .has_value());
}

TEST(ReportPageTest, LabelsTellResultsApart) {
  EXPECT_EQ(ResultLabels({"/data/left/result.json", "/data/right/"}),
            (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(ResultLabels({"/2024/arm", "/2025/arm", "/2025/other"}),
            (std::vector<std::string>{"2024/arm", "2025/arm", "2025/other"}));
  // The same twice: as far as there is something to tell.
  const std::vector<std::string> same = ResultLabels({"/a/b", "/a/b"});
  EXPECT_EQ(same, (std::vector<std::string>{"a/b", "a/b"}));
}

}  // namespace
}  // namespace alidade::internal
