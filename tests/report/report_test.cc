#include "src/report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "src/calibration/verdict.h"
#include "tests/report/report_test_util.h"
#include "tests/report/well_formed.h"

namespace alidade::internal {
namespace {

using testing::Contains;
using testing::Flat;
using testing::Lines;
using testing::MakeMixedSet;
using testing::MakeResult;
using testing::MakeRun;

std::string JudgedReport(CalibrationResult result) {
  JudgeResult(&result);
  return FormatReport(result);
}

TEST(FormatIdentifiabilityTest, TellsEveryDecisionAndItsReason) {
  const std::string text = FormatIdentifiability(MakeResult().identifiability);
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat,
                       "2 of 3 parameters are to be identified, 1 is "
                       "held at the nominal value."));
  EXPECT_TRUE(Contains(flat, "beta1 estimated"));
  EXPECT_TRUE(Contains(flat, "d4 estimated d4 + 0.004 r4"));
  EXPECT_TRUE(Contains(flat, "r4 fixed the axis of joint 4 is parallel"));
  EXPECT_TRUE(Contains(flat, "base_x known"));
  EXPECT_TRUE(Contains(flat, "these poses, nominal 1 of 2 3.2e+11"));
  EXPECT_TRUE(Contains(flat, "these poses, perturbed 2 of 2 full rank"));
  EXPECT_TRUE(Contains(flat, "Weakly identifiable at these poses: beta1 d4"));
  EXPECT_TRUE(Contains(flat, "Warning: the rank is short"));
}

TEST(FormatIdentifiabilityTest, PutsEqualDecisionsInOneRow) {
  IdentifiabilityResult result;
  for (const char* name : {"alpha4", "theta4", "alpha5"}) {
    ParameterDecision decision;
    decision.name = name;
    decision.state = ParameterState::kFixed;
    decision.reason = "its column is zero";
    result.decisions.push_back(decision);
  }
  EXPECT_TRUE(Contains(FormatIdentifiability(result),
                       "alpha4 theta4 alpha5  fixed  its column is zero"));
}

TEST(FormatIdentifiabilityTest, PrintsTheRefusal) {
  IdentifiabilityResult result;
  result.exceeds_rank = true;
  result.refusal = "alpha5 depends on r2";
  EXPECT_TRUE(Contains(FormatIdentifiability(result), "alpha5 depends on r2"));
}

TEST(FormatParametersTest, PrintsMillimetresAndDegrees) {
  const std::string flat = Flat(FormatParameters(MakeResult()));
  EXPECT_TRUE(Contains(
      flat, "beta1 deg 0.000000 0.515662 0.515662 0.515662 0 estimated"));
  EXPECT_TRUE(Contains(flat,
                       "d4 mm 160.000000 160.100400 0.100400 160.100000 "
                       "4.0e-04 estimated"));
  EXPECT_TRUE(
      Contains(flat, "r4 mm 0.000000 0.000000 0.000000 0.100000 -0.10 fixed"));
  EXPECT_TRUE(Contains(flat, "Known, and zero: base_x"));
}

TEST(FormatParametersTest, HasColumnsOfStdAndTruthWhereTheyAreKnown) {
  CalibrationResult result = MakeResult();
  EXPECT_FALSE(Contains(FormatParameters(result), " std "));
  result.parameters[1].std = 2.5e-5;
  for (auto& parameter : result.parameters) parameter.truth.reset();
  const std::string flat = Flat(FormatParameters(result));
  EXPECT_TRUE(Contains(flat, " std "));
  EXPECT_FALSE(Contains(flat, "true value"));
  EXPECT_TRUE(
      Contains(flat, "d4 mm 160.000000 160.100400 0.100400 0.025 estimated"));
  EXPECT_TRUE(
      Contains(flat, "beta1 deg 0.000000 0.515662 0.515662 - estimated"));
}

TEST(FormatAccuracyTableTest, HasBeforeAndAfterOfBothSets) {
  const std::string flat = Flat(FormatAccuracyTable(MakeResult()));
  EXPECT_TRUE(Contains(flat,
                       "training poses before 5.210 5.210 0 5.210 5.210 "
                       "5.210 5"));
  EXPECT_TRUE(Contains(flat, "training poses after 2.100e-13"));
  EXPECT_TRUE(Contains(flat, "validation poses before 5.000"));
  EXPECT_TRUE(Contains(flat, "validation poses after 3.000e-13"));
}

TEST(FormatPublishedTest, IsEmptyWhereNothingIsPublished) {
  CalibrationResult result = MakeResult();
  result.parameters[1].published.reset();
  EXPECT_EQ(FormatPublished(result), "");
  EXPECT_FALSE(Contains(JudgedReport(result), "Published"));
}

TEST(FormatPublishedTest, HasPublishedObtainedAndTheirDifference) {
  const std::string flat = Flat(FormatPublished(MakeResult()));
  EXPECT_TRUE(Contains(flat, "Published: A study of an arm"));
  EXPECT_TRUE(Contains(flat, "d4 mm 160.100000 160.100400 4.0e-04"));
  EXPECT_FALSE(Contains(flat, "beta1"));
}

TEST(FormatComparisonTest, ShowsSolversSideBySide) {
  const std::string text = FormatComparison(MakeResult());
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat, "solver Levenberg-Marquardt pseudo-inverse"));
  EXPECT_TRUE(Contains(flat, "iterations 3 2"));
  EXPECT_TRUE(Contains(flat, "chi-square before 1000 1000"));
  EXPECT_TRUE(Contains(flat, "time to solve 4.20 ms 4.20 ms"));
  EXPECT_TRUE(Contains(flat, "0 5.210 5210 5.210 5210"));
  EXPECT_TRUE(Contains(flat, "1 * 0.03000 30.00 1.000e-05 0.01000"));
  EXPECT_TRUE(Contains(flat, "* the step was rejected"));
  EXPECT_TRUE(Contains(flat, "largest differences: d4 2.0e-12 mm"));
}

TEST(FormatComparisonTest, SaysWhereValuesAreTheSame) {
  CalibrationResult result = MakeResult();
  result.runs[1].values = result.runs[0].values;
  EXPECT_TRUE(Contains(FormatComparison(result), "the same to the last bit"));
}

TEST(FormatComparisonTest, ShortensALongHistory) {
  CalibrationResult result = MakeResult();
  result.runs[0] = MakeRun("ceres", std::vector<double>(1001, 1e-3));
  const std::string text = FormatComparison(result);
  EXPECT_LT(Lines(text).size(), 60U);
  EXPECT_TRUE(Contains(text, "\n     1000 "));
  EXPECT_TRUE(Contains(text, "\n      ..."));
}

TEST(FormatReportTest, BeginsWithTheVerdict) {
  const std::string text = JudgedReport(MakeResult());
  const std::size_t accuracy = text.find("\nAccuracy\n");
  ASSERT_NE(accuracy, std::string::npos);
  const std::string head = Flat(text.substr(0, accuracy));
  EXPECT_TRUE(Contains(
      head,
      "Accepted. The mean position error at 20 validation poses falls from "
      "5.00 mm to 3.00e-13 mm, the numerical precision limit. All acceptance "
      "limits are met. Warning: The rank is short at the nominal geometry."));
}

TEST(FormatReportTest, HasEverySectionAndTheProvenance) {
  const std::string text = JudgedReport(MakeResult());
  for (const char* title :
       {"A calibration\n=", "\nAccuracy\n-", "\nIdentifiability\n-",
        "\nParameters\n-", "\nConvergence\n-", "\nPublished values\n-",
        "\nProvenance\n-"}) {
    EXPECT_TRUE(Contains(text, title)) << title;
  }
  EXPECT_TRUE(Contains(text, "Alidade 1.2.3, seed 42"));
  EXPECT_TRUE(Contains(text, "alidade calibrate job.yaml"));
  EXPECT_TRUE(Contains(text, std::string(64, 'a')));
  EXPECT_TRUE(Contains(text, "whole job 250 ms"));
}

TEST(FormatReportTest, HasNoLineOverAHundredColumns) {
  for (const std::string& line : Lines(JudgedReport(MakeResult()))) {
    EXPECT_LE(line.size(), 100U) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
  }
}

TEST(FormatReportTest, ShoutsAMissedLimit) {
  CalibrationResult result = MakeResult();
  result.acceptance.push_back({"validation_max", 1e-16, 3e-16});
  const std::string flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(flat, "Not accepted. The mean"));
  EXPECT_TRUE(Contains(flat, "1 of 2 acceptance limits is missed."));
  EXPECT_TRUE(Contains(flat, "validation_max mm 1.000e-13 3.000e-13 MISSED"));
}

TEST(FormatReportTest, SaysThatAnUnusableSolutionIsUnusable) {
  CalibrationResult result = MakeResult();
  result.runs[0].summary.status = SolverStatus::kFailed;
  EXPECT_TRUE(Contains(Flat(JudgedReport(result)),
                       "Not usable. Levenberg-Marquardt failed"));
}

TEST(FormatReportTest, WorksOnAnEmptyResult) {
  const std::string text = JudgedReport(CalibrationResult());
  EXPECT_TRUE(Contains(text, "Nothing was calibrated: no solver has run."));
  CalibrationResult refused;
  refused.identifiability.exceeds_rank = true;
  refused.identifiability.refusal = "alpha5 depends on r2.";
  EXPECT_TRUE(Contains(JudgedReport(refused),
                       "Nothing was calibrated: alpha5 depends on r2."));
}

// Training and validation poses of orientation, one of them each.
CalibrationResult MakeResultOfOrientations() {
  CalibrationResult result = MakeResult();
  result.train = MakeMixedSet();
  result.validation = MakeMixedSet();
  result.validation->rotation_after =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.125 * kDegree));
  return result;
}

TEST(FormatReportTest, HasATableOfOrientations) {
  const std::string flat = Flat(JudgedReport(MakeResultOfOrientations()));
  EXPECT_TRUE(Contains(flat,
                       "orientation error [deg] calibration mean rms std "
                       "median p95 max n"));
  EXPECT_TRUE(Contains(flat,
                       "training poses before 0.5000 0.5000 0 0.5000 0.5000 "
                       "0.5000 1"));
  EXPECT_TRUE(Contains(flat,
                       "training poses after 0.2500 0.2500 0 0.2500 0.2500 "
                       "0.2500 1"));
  EXPECT_TRUE(Contains(flat,
                       "validation poses after 0.1250 0.1250 0 0.1250 0.1250 "
                       "0.1250 2"));
  EXPECT_FALSE(Contains(JudgedReport(MakeResult()), "orientation"));
}

// Which kind and target errors belong to, of labelled observations alone.
TEST(FormatReportTest, TellsKindsAndTargetsApart) {
  CalibrationResult result = MakeResult();
  EXPECT_FALSE(Contains(JudgedReport(result), "of which"));
  result.train = MakeMixedSet();
  const std::string flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(flat, "of which, after [mm]"));
  EXPECT_TRUE(Contains(flat,
                       "training poses distance of smr 0.5000 0.5000 0 "
                       "0.5000 0.5000 0.5000 1"));
  EXPECT_TRUE(
      Contains(flat, "training poses position of ball, \"left\" 0 0 0 0"));
  EXPECT_FALSE(Contains(flat, "point distance"));
}

TEST(FormatReportTest, HasCrossValidationOfBoth) {
  CalibrationResult result = MakeResultOfOrientations();
  result.cross_validation = CrossValidation{
      5, SummarizeErrors(Eigen::VectorXd::Constant(2, 0.002)),
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.0625 * kDegree))};
  const std::string flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(
      flat, "cross-validated 5 folds 2.000 2.000 0 2.000 2.000 2.000 2"));
  EXPECT_TRUE(Contains(flat,
                       "cross-validated 5 folds 0.06250 0.06250 0 0.06250 "
                       "0.06250 0.06250 2"));
  result.cross_validation->rotation = {};
  EXPECT_FALSE(Contains(Flat(JudgedReport(result)), "0.06250"));
}

TEST(FormatReportTest, TellsWhatStagesBringToBoth) {
  CalibrationResult result = MakeResultOfOrientations();
  StageResult stage;
  stage.name = "frames only";
  stage.num_free = 12;
  stage.train = SummarizeErrors(Eigen::VectorXd::Constant(2, 0.008));
  stage.validation = SummarizeErrors(Eigen::VectorXd::Constant(2, 0.004));
  stage.train_rotation =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.75 * kDegree));
  stage.validation_rotation =
      SummarizeErrors(Eigen::VectorXd::Constant(2, 0.375 * kDegree));
  result.stages = {stage};
  std::string flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(flat, "Accuracy by stage:"));
  EXPECT_TRUE(Contains(flat, "validation mean rms std median p95 max [mm]"));
  EXPECT_TRUE(Contains(flat, "frames only 12 4.000 4.000 0 4.000 4.000 4.000"));
  EXPECT_TRUE(Contains(
      flat, "validation orientation mean rms std median p95 max [deg]"));
  EXPECT_TRUE(
      Contains(flat, "frames only 12 0.3750 0.3750 0 0.3750 0.3750 0.3750"));
  // Without validation poses those of the training count.
  result.validation.reset();
  flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(flat, "frames only 12 8.000 8.000 0 8.000 8.000 8.000"));
  EXPECT_TRUE(
      Contains(flat, "frames only 12 0.7500 0.7500 0 0.7500 0.7500 0.7500"));
}

TEST(FormatReportTest, ListsRejectedRows) {
  CalibrationResult result = MakeResult();
  EXPECT_FALSE(Contains(JudgedReport(result), "Rejected rows"));
  result.rejected = {{"poses.csv", 17, "q2 is no number"}};
  std::string flat = Flat(JudgedReport(result));
  EXPECT_TRUE(
      Contains(flat, "1 row took no part. result.json lists all of them."));
  EXPECT_TRUE(Contains(flat, "poses.csv 17 q2 is no number"));
  for (int line = 100; line < 140; ++line) {
    result.rejected.push_back({"poses.csv", line, "empty"});
  }
  flat = Flat(JudgedReport(result));
  EXPECT_TRUE(Contains(flat, "41 rows took no part."));
  EXPECT_TRUE(Contains(flat, "The first 30:"));
  EXPECT_TRUE(Contains(flat, "poses.csv 128 empty"));
  EXPECT_FALSE(Contains(flat, "poses.csv 129 empty"));
}

TEST(FormatReportTest, TellsWhatRepeatsDifferBy) {
  CalibrationResult result = MakeResult();
  EXPECT_FALSE(Contains(JudgedReport(result), "Repeated"));
  result.repeats.length = 2.5e-5;
  result.repeats.length_degrees_of_freedom = 27;
  EXPECT_TRUE(Contains(Flat(JudgedReport(result)),
                       "Repeated configurations differ by 0.0250 mm in a "
                       "coordinate (standard deviation, 27 degrees of "
                       "freedom): what no geometry can take away."));
  result.repeats.rotation = 0.125 * kDegree;
  result.repeats.rotation_degrees_of_freedom = 9;
  EXPECT_TRUE(Contains(Flat(JudgedReport(result)),
                       "27 degrees of freedom) and 0.125 deg in orientation: "
                       "what no geometry can take away."));
}

TEST(FormatReportTest, NamesTargetsAndPointsAndUnitsOfLimits) {
  CalibrationResult result = MakeResultOfOrientations();
  result.aliases = {{"tool2", "smr2"}, {"point1", "A"}};
  result.acceptance.push_back(
      {"validation_rotation_max", kDegree, 0.5 * kDegree, Dimension::kAngle});
  const std::string text = JudgedReport(result);
  const std::string flat = Flat(text);
  EXPECT_TRUE(Contains(flat, "tool2 is smr2, point1 is A."));
  EXPECT_TRUE(Contains(flat, "validation_rotation_max deg 1.000 0.5000 met"));
  for (const std::string& line : Lines(text)) {
    EXPECT_LE(line.size(), 100U) << line;
  }
}

}  // namespace
}  // namespace alidade::internal
