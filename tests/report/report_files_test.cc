// Tables in CSV and figures.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "src/report/report.h"
#include "tests/report/report_test_util.h"
#include "tests/report/well_formed.h"
#include "tests/support/edit.h"

namespace alidade::internal {
namespace {

using testing::Cells;
using testing::Contains;
using testing::ContentOf;
using testing::Lines;
using testing::MakeMixedSet;
using testing::MakeResult;
using testing::MakeSet;

TEST(MakeCsvFilesTest, ColumnsReadBack) {
  const CalibrationResult result = MakeResult();
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0],
            "pose,q1_deg,q2_mm,x_mm,y_mm,z_mm,before_dx_mm,before_dy_mm,"
            "before_dz_mm,before_error_mm,after_dx_mm,after_dy_mm,after_dz_mm,"
            "after_error_mm");
  for (std::size_t pose = 1; pose < lines.size(); ++pose) {
    const std::vector<std::string> cells = Cells(lines[pose]);
    ASSERT_EQ(cells.size(), 14U);
    EXPECT_EQ(cells[0], std::to_string(pose));
    EXPECT_EQ(cells[1], "45");
    EXPECT_EQ(cells[2], "12");
    const auto column = static_cast<Eigen::Index>(pose - 1);
    EXPECT_EQ(std::atof(cells[3].c_str()),
              result.train.positions(0, column) / kMillimetre);
    EXPECT_EQ(std::atof(cells[8].c_str()),
              result.train.residual_before(2, column) / kMillimetre);
    EXPECT_EQ(std::atof(cells[9].c_str()),
              result.train.residual_before.col(column).norm() / kMillimetre);
    EXPECT_EQ(std::atof(cells[13].c_str()), 2.1e-16 / kMillimetre);
  }
}

// Longer than a piece: nothing is lost, doubled or out of order where one ends.
TEST(MakeCsvFilesTest, GivesManyRowsInSeveralPieces) {
  constexpr int kPoses = 10000;
  CalibrationResult result = MakeResult();
  result.train = MakeSet(kPoses, 5.21e-3, 2.1e-16);
  const ReportFile file = MakeCsvFiles(result).front();
  ASSERT_EQ(file.name, "residuals.csv");
  std::string text;
  int pieces = 0;
  file.content([&](std::string_view piece) {
    // 256 KiB, and a row of 14 numbers of at most 24 characters.
    EXPECT_LE(piece.size(), (1U << 18) + 14 * 25);
    text += piece;
    ++pieces;
  });
  EXPECT_GE(pieces, 3);
  const std::vector<std::string> lines = Lines(text);
  ASSERT_EQ(lines.size(), kPoses + 1U);
  for (int pose = 0; pose < kPoses; ++pose) {
    const std::vector<std::string> cells = Cells(lines[pose + 1]);
    ASSERT_EQ(cells.size(), 14U) << lines[pose + 1];
    EXPECT_EQ(cells[0], std::to_string(pose + 1));
    EXPECT_EQ(std::atof(cells[4].c_str()),
              result.train.positions(1, pose) / kMillimetre);
  }
  EXPECT_EQ(text.back(), '\n');
  EXPECT_EQ(file.Text(), text);  // the same when asked again
}

TEST(MakeUncertaintyFilesTest, InfluenceHasARowForEachPose) {
  CalibrationResult result = MakeResult();
  result.uncertainty.emplace();
  result.uncertainty->residuals.poses = {{0, "", 0.25, 1e-3, 1.5},
                                         {2, "a.csv:4", 0.5, 0.0, 2.0}};
  EXPECT_EQ(ContentOf(MakeUncertaintyFiles(result), "influence.csv"),
            "pose,leverage,cooks_distance,standardised_residual\n"
            "1,0.25,0.001,1.5\n"
            "3,0.5,0,2\n");
}

TEST(MakeCsvFilesTest, HasEveryIterationOfEverySolver) {
  const CalibrationResult result = MakeResult();
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(result), "iterations.csv"));
  ASSERT_EQ(lines.size(), 1U + 4U + 3U);
  EXPECT_EQ(lines[0],
            "solver,iteration,cost,max_error_mm,rms_error_mm,step_norm,"
            "accepted,time_s");
  const std::vector<std::string> cells = Cells(lines[2]);
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[0], "ceres");
  EXPECT_EQ(cells[1], "1");
  EXPECT_EQ(std::atof(cells[3].c_str()), 3e-5 / kMillimetre);
  EXPECT_EQ(cells[6], "false");
  EXPECT_EQ(Cells(lines[5])[0], "pseudo_inverse");
}

TEST(MakeCsvFilesTest, HasValidationPosesOnlyWhereThereAreAny) {
  CalibrationResult result = MakeResult();
  EXPECT_EQ(Lines(ContentOf(MakeCsvFiles(result), "validation.csv")).size(),
            21U);
  result.validation.reset();
  EXPECT_EQ(MakeCsvFiles(result).size(), 2U);
}

TEST(MakeFiguresTest, EachIsWellFormedAndHasItsHeadline) {
  const std::vector<ReportFile> files = MakeFigures(MakeResult());
  ASSERT_EQ(files.size(), 5U);
  for (const ReportFile& file : files) {
    EXPECT_EQ(WhatIsMalformed(file.Text()), "") << file.name;
    EXPECT_FALSE(Contains(file.Text(), "no data")) << file.name;
  }
  EXPECT_TRUE(Contains(ContentOf(files, "error_before.svg"), "5.21"));
  EXPECT_TRUE(Contains(ContentOf(files, "error_after.svg"), "2.10"));
  const std::string convergence = ContentOf(files, "convergence.svg");
  EXPECT_TRUE(Contains(convergence, "after 3 iterations"));
  EXPECT_TRUE(Contains(convergence, "after 2 iterations"));
  EXPECT_TRUE(Contains(convergence, "numerical precision limit"));
}

TEST(MakeFiguresTest, ValidationIsAMapOnlyInAHorizontalPlane) {
  CalibrationResult result = MakeResult();
  EXPECT_TRUE(Contains(ContentOf(MakeFigures(result), "validation_after.svg"),
                       ">x [mm]</text>"));
  testing::Edit(&result.validation->positions).at(2, 3) += 0.05;
  const std::string svg =
      ContentOf(MakeFigures(result), "validation_after.svg");
  EXPECT_FALSE(Contains(svg, ">x [mm]</text>"));
  EXPECT_TRUE(Contains(svg, ">validation pose</text>"));
}

TEST(MakeFiguresTest, DependsOnNothingButTheResult) {
  const std::vector<ReportFile> first = MakeFigures(MakeResult());
  const std::vector<ReportFile> second = MakeFigures(MakeResult());
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].Text(), second[i].Text());
  }
}

TEST(MakeFiguresTest, SaysNoDataForAnEmptyResult) {
  for (const ReportFile& file : MakeFigures(CalibrationResult())) {
    EXPECT_EQ(WhatIsMalformed(file.Text()), "");
    EXPECT_TRUE(Contains(file.Text(), "no data")) << file.name;
  }
}

std::vector<std::string> MixedLines() {
  CalibrationResult result = MakeResult();
  result.train = MakeMixedSet();
  return Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
}

TEST(MakeCsvFilesTest, LabelsObservationsOfSeveralKinds) {
  const std::vector<std::string> lines = MixedLines();
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0],
            "pose,kind,target,where,q1_deg,q2_mm,x_mm,y_mm,z_mm,before_dx_mm,"
            "before_dy_mm,before_dz_mm,before_error_mm,after_dx_mm,after_dy_mm,"
            "after_dz_mm,after_error_mm,before_rotation_deg,"
            "after_rotation_deg");
  // Names are quoted where they hold a comma or quotes, which are doubled.
  EXPECT_EQ(lines[1],
            "2,position,\"ball, \"\"left\"\"\",\"data,1.csv:12\",90,16,"
            "250,500,125,3,0,4,5,0,0,0,0,,");
  // No position and no orientation was measured: empty cells.
  EXPECT_EQ(lines[2],
            "1,distance,smr,data.csv:7,45,12,,,,-2,0,0,2,0.5,0,0,0.5,,");
  EXPECT_EQ(lines[3], "2,pose,,,90,16,,,,,,,,,,,,0.5,0.25");
  // Of no pose.
  EXPECT_EQ(lines[4], ",point distance,,,,,,,,1,0,0,1,0,0,0,0,,");
}

TEST(MakeCsvFilesTest, HasNoColumnsOfRotationsWithoutOrientations) {
  CalibrationResult result = MakeResult();
  result.train = MakeMixedSet();
  result.train.rotation_residual_before = Eigen::MatrixXd(3, 0);
  result.train.rotation_residual_after = Eigen::MatrixXd(3, 0);
  const std::string text = ContentOf(MakeCsvFiles(result), "residuals.csv");
  EXPECT_FALSE(Contains(text, "rotation"));
  EXPECT_TRUE(Contains(
      text, "1,distance,smr,data.csv:7,45,12,,,,-2,0,0,2,0.5,0,0,0.5\n"));
}

// No name breaks the lines of a table.
TEST(MakeCsvFilesTest, KeepsAnObservationInOneLine) {
  CalibrationResult result = MakeResult();
  result.train = MakeMixedSet();
  result.train.labels[0].target = "one\ntwo";
  const std::vector<std::string> lines =
      Lines(ContentOf(MakeCsvFiles(result), "residuals.csv"));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_TRUE(Contains(lines[1], ",\"one two\","));
}

}  // namespace
}  // namespace alidade::internal
