// Errors that are not rigid geometry, as people see them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "src/common/text.h"
#include "src/report/error_term_tables.h"
#include "src/report/figures.h"
#include "src/report/report.h"
#include "src/report/result_page.h"
#include "tests/report/report_test_util.h"
#include "tests/report/well_formed.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kPoses = 201;

ErrorRung MakeRung(const std::string& name, int num_terms, double weight,
                   double error) {
  ErrorRung rung;
  rung.name = name;
  rung.num_terms = num_terms;
  rung.weight = weight;
  rung.region_error = 1.1 * error;
  rung.random_error = 1.05 * error;
  rung.train = SummarizeErrors(Eigen::VectorXd::Constant(5, 0.9 * error));
  rung.validation = SummarizeErrors(Eigen::VectorXd::Constant(20, error));
  return rung;
}

// A revolute joint that bends and has a function, 2 mrad where it was measured
// (-0.35 to 0.35 rad) and 7 mrad beyond; and a prismatic one that does nothing.
CalibrationResult MakeErrorResult() {
  CalibrationResult result = testing::MakeResult();
  result.validation->after =
      SummarizeErrors(Eigen::VectorXd::Constant(20, 1e-4));
  result.arm.joints.resize(2);
  result.arm.joints[1].type = JointType::kPrismatic;
  result.arm.errors.joints.resize(2);
  JointErrors& joint = result.arm.errors.joints[0];
  joint.compliance << 0.0, 1e-5, 4.5e-5;
  joint.function.first = -0.5;
  joint.function.spacing = 0.1;
  joint.function.values = Eigen::VectorXd::Constant(11, 2e-3);
  joint.function.values.head<2>().setConstant(7e-3);
  joint.function.values.tail<2>().setConstant(7e-3);
  joint.function.deviations = Eigen::VectorXd::Constant(11, 1e-4);
  joint.harmonics = {{2.0, 3e-4, 0.0}};
  ErrorTermsResult& errors = result.error_terms.emplace();
  errors.share = 0.9;
  errors.sentence = "error terms are estimated";
  errors.region_error = 1.2e-4;
  errors.random_error = 1.1e-4;
  errors.rungs = {MakeRung("geometry", 0, 0.1, 4e-4),
                  MakeRung("elasticity + functions", 17, 0.9, 9e-5)};
  errors.rungs[1].compliance_std = 3.6e-5;
  errors.rungs[1].function_std = 6.4e-4;
  errors.terms = {{"k1_z", 4.5e-5, 1.2e-5, "rad/(N m)"},
                  {"h1_c2", 3e-4, 2e-5, "rad"}};
  errors.effects = {{0, "all", 3e-4, 1e-3},
                    {1, "elasticity", 1e-4, 2e-4},
                    {1, "function", 2.5e-4, 9e-4},
                    {1, "all", 3e-4, 1e-3}};
  errors.measured = {{1, -0.35, 0.35}, {2, 0.0, 0.1}};
  JointResiduals& residuals = errors.residuals;
  residuals.joint_values.setZero(2, kPoses);
  residuals.geometry.setConstant(2, kPoses, std::nan(""));
  residuals.remaining.setConstant(2, kPoses, std::nan(""));
  for (int k = 0; k < kPoses; ++k) {
    residuals.poses.push_back(2 * k);
    residuals.joint_values(0, k) = -0.35 + 0.7 * k / (kPoses - 1);
    residuals.geometry(0, k) = 2e-3;
    residuals.remaining(0, k) = k % 2 == 0 ? 1e-4 : -1e-4;
  }
  residuals.remaining(0, 7) = 1.0;  // a lost target
  return result;
}

TEST(ErrorTermTablesTest, RungsEndWithWhatIsDelivered) {
  const CalibrationResult result = MakeErrorResult();
  const std::string text =
      testing::Flat(RungTable(*result.error_terms, result).ToText());
  EXPECT_THAT(text, HasSubstr("geometry 0 10.0 0.440 0.420 0.400 0.400 -"));
  EXPECT_THAT(text, HasSubstr("17 90.0 0.0990 0.0945 0.0900 0.0900 -"));
  // Two coefficients and eleven knots; a quarter of the error is left.
  EXPECT_THAT(text, HasSubstr("delivered 13 0.120 0.110 0.100 0.100 -"));
  EXPECT_THAT(RungTable(*result.error_terms, result).ToHtml(),
              HasSubstr("\u221275</td>"));
}

TEST(ErrorTermTablesTest, SizesOfFunctionsAreOfWhatWasMeasured) {
  const CalibrationResult result = MakeErrorResult();
  EXPECT_THAT(
      testing::Flat(
          FunctionTable(result.arm, result.error_terms->measured).ToText()),
      HasSubstr("1 -20.05 20.05 deg 11 2.00 2.00 0.10 mrad"));
  // All knots: root of (7 * 4 + 4 * 49) / 11.
  EXPECT_THAT(testing::Flat(FunctionTable(result.arm, {}).ToText()),
              HasSubstr("1 -28.65 28.65 deg 11 4.51 7.00 0.10 mrad"));
}

TEST(ErrorTermTablesTest, ReportStatesTermsWithTheirStandardDeviations) {
  const CalibrationResult result = MakeErrorResult();
  const std::string report = FormatReport(result);
  for (const std::string& line : testing::Lines(report)) {
    EXPECT_LE(Utf8Length(line), kReportWidth) << line;
  }
  const std::string text = testing::Flat(report);
  EXPECT_THAT(text, HasSubstr("Error terms are estimated. What is delivered "
                              "has 13 coefficients"));
  EXPECT_THAT(text, HasSubstr("1 0 0.0100 0.045 ± 0.012"));
  EXPECT_THAT(text, HasSubstr("h1_c2 cosine of 2.000 per turn of joint 1 0.300 "
                              "± 0.020 mrad"));
  EXPECT_THAT(text, HasSubstr("together - - 0.300 1.00"));
  EXPECT_THAT(text, HasSubstr("90 % is taken"));
}

TEST(ErrorTermTablesTest, RigidArmsHaveNothingToShow) {
  CalibrationResult result = MakeErrorResult();
  EXPECT_EQ(FormatArmErrors(Arm()), "");
  EXPECT_THAT(FormatArmErrors(result.arm), HasSubstr("Compliances"));
  result.error_terms->share = 0.0;
  result.error_terms->sentence = "no error terms: no evidence";
  result.arm.errors = {};
  EXPECT_THAT(FormatReport(result), HasSubstr("No error terms: no evidence."));
  EXPECT_EQ(MakeErrorTermFiles(result).size(), 1U);  // what was weighed
  result.error_terms.reset();
  EXPECT_TRUE(MakeErrorTermFiles(result).empty());
  EXPECT_EQ(ErrorTermsSection(result), "");
}

TEST(ErrorTermFilesTest, FunctionsReadBack) {
  const std::vector<std::string> lines = testing::Lines(testing::ContentOf(
      MakeErrorTermFiles(MakeErrorResult()), "joint_functions.csv"));
  ASSERT_EQ(lines.size(), 12U);
  EXPECT_EQ(lines[0], "joint,q,q_unit,value,std,unit,measured");
  const std::vector<std::string> beyond = testing::Cells(lines[1]);
  ASSERT_EQ(beyond.size(), 7U);
  EXPECT_EQ(std::atof(beyond[1].c_str()), -0.5 / kDegree);
  EXPECT_EQ(beyond[2], "deg");
  EXPECT_EQ(beyond[3], "7");
  EXPECT_EQ(beyond[5], "mrad");
  EXPECT_EQ(beyond[6], "false");
  EXPECT_EQ(testing::Cells(lines[6])[6], "true");
}

TEST(ErrorTermFilesTest, ResidualsHaveARowAPose) {
  const std::vector<std::string> lines = testing::Lines(testing::ContentOf(
      MakeErrorTermFiles(MakeErrorResult()), "joint_residuals.csv"));
  ASSERT_EQ(lines.size(), kPoses + 1U);
  EXPECT_EQ(lines[0],
            "pose,q1_deg,geometry1_mrad,remaining1_mrad,q2_mm,geometry2_mm,"
            "remaining2_mm");
  const std::vector<std::string> cells = testing::Cells(lines[3]);
  ASSERT_GE(cells.size(), 5U);
  EXPECT_EQ(cells[0], "5");
  EXPECT_EQ(cells[2], "2");
  EXPECT_EQ(cells[3], "0.1");
  EXPECT_TRUE(lines[3].find(",0,,") != std::string::npos);  // of joint 2
}

TEST(ErrorTermFilesTest, FiguresAreWellFormed) {
  const std::vector<ReportFile> files = MakeErrorTermFiles(MakeErrorResult());
  EXPECT_EQ(files.size(), 6U);
  for (const ReportFile& file : files) {
    if (file.name.find(".svg") == std::string::npos) continue;
    EXPECT_EQ(WhatIsMalformed(file.Text()), "") << file.name;
    EXPECT_THAT(file.Text(), Not(HasSubstr("no data"))) << file.name;
  }
  EXPECT_THAT(testing::ContentOf(files, "joint_functions.svg"),
              HasSubstr(">Error of joint 1</text>"));
}

// The series of a chart that has this label.
const ChartSeries& SeriesOf(const LineChart& chart, const std::string& label) {
  for (const ChartSeries& series : chart.series) {
    if (series.label == label) return series;
  }
  ADD_FAILURE() << "no series " << label;
  return chart.series.front();
}

TEST(JointFunctionChartTest, BandIsAboutTheFunctionAndEndsWhereMeasured) {
  const std::optional<LineChart> chart =
      JointFunctionChart(MakeErrorResult(), 0);
  ASSERT_TRUE(chart);
  EXPECT_FALSE(JointFunctionChart(MakeErrorResult(), 1));
  const ChartSeries& measured = SeriesOf(*chart, "function, 95 %");
  const ChartSeries& beyond = SeriesOf(*chart, "not measured");
  int num_measured = 0;
  for (std::size_t k = 0; k < measured.x.size(); ++k) {
    const double q = measured.x[k] * kDegree;
    if (std::isnan(measured.y[k])) {
      EXPECT_GT(std::abs(q), 0.35);
      EXPECT_FALSE(std::isnan(beyond.y[k]));
      continue;
    }
    ++num_measured;
    EXPECT_LE(std::abs(q), 0.35 + 1e-12);
    if (std::abs(q) < 0.3) {
      EXPECT_NEAR(measured.y[k], 2.0 + 0.3 * std::cos(2.0 * q), 1e-9);
    }
    EXPECT_NEAR(measured.upper[k] - measured.lower[k], 2.0 * 1.96 * 0.1, 1e-9);
  }
  EXPECT_GT(num_measured, 100);
}

TEST(JointFunctionChartTest, DotsAreResidualsAboutTheFunction) {
  const std::optional<LineChart> chart =
      JointFunctionChart(MakeErrorResult(), 0);
  ASSERT_TRUE(chart);
  const ChartSeries& dots = SeriesOf(*chart, "training poses");
  ASSERT_EQ(dots.x.size(), std::size_t{kPoses});
  EXPECT_NEAR(dots.x[100], 0.0, 1e-12);
  EXPECT_NEAR(dots.y[100], 2.0 + 0.3 + 0.1, 1e-9);
  // A single one of a radian does not flatten the others.
  EXPECT_LT(chart->y.upper, 20.0);
  EXPECT_EQ(chart->subtitle, "1 residual is beyond the chart");
}

TEST(JointResidualChartTest, ShowsBothStates) {
  const std::optional<LineChart> chart =
      JointResidualChart(MakeErrorResult(), 0);
  ASSERT_TRUE(chart);
  EXPECT_NEAR(SeriesOf(*chart, "geometry alone").y[3], 2.0, 1e-12);
  EXPECT_NEAR(SeriesOf(*chart, "with error terms").y[3], -0.1, 1e-12);
  // Nothing measured joint 2.
  EXPECT_FALSE(JointResidualChart(MakeErrorResult(), 1));
}

TEST(ErrorTermsPageTest, ShowsEveryPartAndNothingOfRigidArms) {
  CalibrationResult result = MakeErrorResult();
  const std::string page = RenderResultPage(result, "{}", {});
  for (const char* figure :
       {"stages-figure", "effects", "function-1", "residuals-of-joint-1"}) {
    EXPECT_THAT(page, HasSubstr("<figure id=\"" + std::string(figure) + "\""));
  }
  EXPECT_THAT(page, Not(HasSubstr("<figure id=\"function-2\"")));
  for (const char* table :
       {"error-rungs", "error-priors", "compliances", "joint-functions",
        "other-terms", "error-effects"}) {
    EXPECT_THAT(page, HasSubstr("<table id=\"" + std::string(table) + "\""));
  }
  result.error_terms.reset();
  EXPECT_THAT(RenderResultPage(result, "{}", {}),
              Not(HasSubstr("not rigid geometry")));
}

}  // namespace
}  // namespace alidade::internal
