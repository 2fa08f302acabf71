// The uncertainty budget and ISO 9283 as text, page, CSV and JSON.

#include "src/report/budget_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "alidade/result_file.h"
#include "tests/report/report_test_util.h"

namespace alidade::internal {
namespace {

using testing::Contains;
using testing::ContentOf;
using testing::Flat;
using testing::Lines;

CalibrationResult Budgeted() {
  CalibrationResult result = testing::MakeResult();
  UncertaintyBudget budget;
  budget.region = {
      {Eigen::Vector3d(0.2, -0.3, 0.1), Eigen::Vector3d(0.7, 0.3, 0.8)}};
  budget.configurations = 500;
  budget.contributions = {
      {BudgetSource::kParameters, EvaluationType::kA, 3e-5, 40.0,
       "covariance of the fit"},
      {BudgetSource::kMeasurement, EvaluationType::kB, 4e-5,
       std::numeric_limits<double>::infinity(), "as stated"}};
  budget.parameters = {{"theta2", Dimension::kAngle, 1e-4, 0.25},
                       {"d3", Dimension::kLength, 2e-5, 0.5}};
  budget.position = {3e-5, 40.0, 2.021, 6.063e-5, 8e-5};
  budget.measured = {5e-5, 308.6, 1.968, 9.84e-5, 1.4e-4};
  budget.worst_std = 4.5e-5;
  result.uncertainty.emplace().budget = budget;
  PosePerformance one;
  one.pose = 4;
  one.n = 5;
  one.before = 2.5e-3;
  one.accuracy = 1.25e-4;
  one.mean_distance = 2e-5;
  one.distance_std = 1e-5;
  PosePerformanceSummary summary;
  summary.poses = "training";
  summary.configurations = 1;
  summary.fewest = 5;
  summary.before = SummarizeErrors(Eigen::VectorXd::Constant(1, one.before));
  summary.accuracy =
      SummarizeErrors(Eigen::VectorXd::Constant(1, one.accuracy));
  summary.repeatability =
      SummarizeErrors(Eigen::VectorXd::Constant(1, one.repeatability()));
  summary.each = {one};
  result.pose_performance = {summary};
  return result;
}

TEST(BudgetReportTest, TextAndPageSayWhatTheBudgetHolds) {
  const CalibrationResult result = Budgeted();
  const std::string text = BudgetText(result);
  for (const std::string& line : Lines(text)) EXPECT_LE(line.size(), 104U);
  const std::string html = BudgetSection(result).html;
  for (const char* part :
       {"x from 200 to 700", "an expanded uncertainty of 0.0606 mm",
        "(coverage factor 2.02, 95.0 %, JCGM 100:2008)",
        "are within 0.0800 mm"}) {
    EXPECT_TRUE(Contains(Flat(text), part)) << part << "\n" << text;
    EXPECT_TRUE(Contains(html, part)) << part;
  }
  // 9 / 25 of the variance, and RP = 0.02 + 3 * 0.01 mm.
  EXPECT_TRUE(
      Contains(Flat(text), "parameters A 0.0300 40.0 each its own 36.0"))
      << text;
  EXPECT_TRUE(Contains(Flat(text), "training 1 5 2.50 2.50 0.125 0.125 0.0500"))
      << text;
  EXPECT_EQ(BudgetText(testing::MakeResult()), "");
  EXPECT_EQ(BudgetSection(testing::MakeResult()).html, "");
}

TEST(BudgetReportTest, FilesHoldAllNumbers) {
  const std::vector<ReportFile> files = MakeBudgetFiles(Budgeted());
  const std::vector<std::string> budget = Lines(ContentOf(files, "budget.csv"));
  ASSERT_EQ(budget.size(), 11U);
  EXPECT_EQ(budget[1], "parameters,A,mm,0.03,40,1,0.03,covariance of the fit");
  EXPECT_EQ(budget[4],
            "d3,A,mm,0.02,40,0.5,0.01,"
            "part of parameters without correlations");
  EXPECT_EQ(budget[5].rfind("combined: the arm's position,,mm,0.03,40", 0), 0U)
      << budget[5];
  const std::vector<std::string> iso = Lines(ContentOf(files, "iso9283.csv"));
  ASSERT_EQ(iso.size(), 2U);
  EXPECT_EQ(iso[1].rfind("training,5,,5,2.5,0.125,0.02,0.01,0.05", 0), 0U)
      << iso[1];
}

TEST(BudgetReportTest, ResultsReadBack) {
  const CalibrationResult result = Budgeted();
  const CalibrationResult read = ParseResult(FormatResult(result));
  ASSERT_TRUE(read.uncertainty && read.uncertainty->budget);
  EXPECT_EQ(BudgetText(read), BudgetText(result));
  EXPECT_EQ(ContentOf(MakeBudgetFiles(read), "budget.csv"),
            ContentOf(MakeBudgetFiles(result), "budget.csv"));
  EXPECT_EQ(ContentOf(MakeBudgetFiles(read), "iso9283.csv"),
            ContentOf(MakeBudgetFiles(result), "iso9283.csv"));
}

}  // namespace
}  // namespace alidade::internal
