#include "alidade/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace alidade::internal::comparison_test {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The example of Iglewicz and Hoaglin: the median is 2.45, the MAD 0.15, and
// 0.6745 (8.2 - 2.45) / 0.15 = 25.86.
TEST(RobustScoresTest, AgreeWithAnExampleByHand) {
  const RobustScores scores = ScoreRobustly(
      {2.1, 2.6, 2.4, 2.5, 2.3, 2.1, 2.3, 2.6, 8.2, 8.3}, 0.0, 0.0);
  EXPECT_NEAR(scores.median, 2.45, 1e-15);
  EXPECT_NEAR(scores.spread, 1.4826 * 0.15, 1e-15);
  // 1 / 1.4826 is 0.6745 to four digits.
  EXPECT_NEAR(scores.scores[8], 0.6745 * 5.75 / 0.15, 2e-3);
  EXPECT_NEAR(scores.scores[0], -0.35 / (1.4826 * 0.15), 1e-12);
}

TEST(RobustScoresTest, FloorHoldsWhereValuesHardlyScatter) {
  const RobustScores scores = ScoreRobustly({2.0, 2.0, 2.0, 2.5}, 0.1, 0.05);
  EXPECT_NEAR(scores.spread, 0.25, 1e-15);
  EXPECT_NEAR(scores.scores[3], 2.0, 1e-15);
  EXPECT_TRUE(std::isnan(ScoreRobustly({2.0, 2.0}, 0.0, 0.0).scores[0]));
}

TEST(RobustScoresTest, WhatIsNoNumberDoesNotCount) {
  const RobustScores scores = ScoreRobustly({kNone, 1.0, 2.0, 3.0}, 0.0, 0.0);
  EXPECT_EQ(scores.median, 2.0);
  EXPECT_NEAR(scores.spread, 1.4826, 1e-15);
  EXPECT_TRUE(std::isnan(scores.scores[0]));
  EXPECT_TRUE(std::isnan(ScoreRobustly({kNone}, 0.0, 1.0).scores[0]));
}

ComparedResult MakeArm(const std::string& label, double before, double after) {
  ComparedResult arm;
  arm.label = label;
  arm.before.mean = before;
  arm.after.mean = after;
  arm.is_validated = true;
  return arm;
}

void AddParameter(const std::string& name, double deviation, double std,
                  ComparedResult* arm) {
  arm->parameters.push_back(
      {name, Dimension::kLength, 0.25 + deviation, deviation, std, true});
}

// Four arms whose mean errors have median 1 mm and MAD 0.1 mm together with any
// fifth that is worse.
std::vector<ComparedResult> FleetWith(double error) {
  return {MakeArm("a", 8e-3, 0.8e-3), MakeArm("b", 8e-3, 0.9e-3),
          MakeArm("c", 8e-3, 1.0e-3), MakeArm("d", 8e-3, 1.1e-3),
          MakeArm("e", 8e-3, error)};
}

TEST(CompareFleetTest, ThresholdIsMetFromBothSides) {
  const double limit = 1e-3 + 3.5 * 1.4826 * 0.1e-3;
  const FleetSummary typical = CompareFleet(FleetWith(limit - 1e-9), 0);
  EXPECT_EQ(typical.level, FindingLevel::kPassed);
  EXPECT_EQ(typical.title, "No outlier");
  EXPECT_EQ(typical.sentence, "None of 5 arms is an outlier.");
  EXPECT_FALSE(typical.arms[0].is_outlier);
  const FleetSummary fleet = CompareFleet(FleetWith(limit + 1e-9), 0);
  EXPECT_EQ(fleet.level, FindingLevel::kAttention);
  EXPECT_EQ(fleet.title, "1 outlier");
  EXPECT_EQ(fleet.sentence,
            "e is an outlier among 5 arms: mean error after calibration "
            "1.52 mm, typically 1.00 mm (z = 3.50).");
  EXPECT_FALSE(fleet.is_small);
  ASSERT_EQ(fleet.arms.size(), 5U);
  const FleetArm& arm = fleet.arms[0];
  EXPECT_EQ(arm.result, 4U);
  EXPECT_TRUE(arm.is_outlier);
  EXPECT_NEAR(arm.score, 3.5, 1e-4);
  EXPECT_EQ(arm.findings[0].level, FindingLevel::kPassed);
  EXPECT_EQ(arm.findings[1].level, FindingLevel::kAttention);
  EXPECT_EQ(arm.findings[1].threshold, 3.5);
  EXPECT_FALSE(fleet.arms[1].is_outlier);
}

// A small error is no reason to look twice, and what scatters by less than a
// tenth of the median is no outlier.
TEST(CompareFleetTest, OnlyLargeErrorsCount) {
  EXPECT_EQ(CompareFleet(FleetWith(1e-9), 0).title, "No outlier");
  std::vector<ComparedResult> fleet = FleetWith(1.3e-3);
  for (int i = 0; i < 4; ++i) fleet[i].after.mean = 1e-3;
  EXPECT_EQ(CompareFleet(fleet, 0).title, "No outlier");
  fleet[4].after.mean = 1.36e-3;
  EXPECT_EQ(CompareFleet(fleet, 0).title, "1 outlier");
}

TEST(CompareFleetTest, GeometryCountsByItsParameters) {
  std::vector<ComparedResult> arms = FleetWith(1.05e-3);
  const double wobble[] = {-2e-5, -1e-5, 0.0, 1e-5, 2e-5};
  for (std::size_t i = 0; i < arms.size(); ++i) {
    AddParameter("d2", wobble[i], 1e-6, &arms[i]);
    AddParameter("d3", i == 1 ? 5e-3 : -wobble[i], 1e-6, &arms[i]);
    // Free in two arms only: not compared.
    if (i < 2) AddParameter("r4", i == 0 ? 1.0 : 0.0, 1e-6, &arms[i]);
  }
  const FleetSummary fleet = CompareFleet(arms, 0);
  ASSERT_EQ(fleet.parameters.size(), 2U);
  const FleetArm& arm = fleet.arms[0];
  EXPECT_EQ(arm.result, 1U);
  EXPECT_TRUE(arm.is_outlier);
  EXPECT_EQ(fleet.parameters[*arm.most_different].name, "d3");
  // d2: MAD 1e-5. d3: median 0, MAD 2e-5, the large score cut at 10.
  const double d2 = 1.0 / 1.4826;
  EXPECT_NEAR(fleet.geometry.values[1], std::sqrt((d2 * d2 + 100.0) / 2.0),
              1e-9);
  EXPECT_NE(fleet.sentence.find("b is an outlier among 5 arms: geometry unlike "
                                "that of the others, most in d3 (+5.00 mm from "
                                "nominal) (z = "),
            std::string::npos)
      << fleet.sentence;
}

TEST(CompareFleetTest, FailuresAndFewArmsAreSaid) {
  std::vector<ComparedResult> arms = FleetWith(1e-3);
  FleetSummary fleet = CompareFleet(arms, 2);
  EXPECT_EQ(fleet.level, FindingLevel::kFailed);
  EXPECT_EQ(fleet.sentence,
            "None of 5 arms is an outlier. 2 calibrations failed.");
  arms.pop_back();
  fleet = CompareFleet(arms, 0);
  EXPECT_TRUE(fleet.is_small);
  EXPECT_EQ(CompareFleet({}, 3).sentence, "Every calibration failed.");
}

TEST(CompareFleetTest, NamesFourOutliersAtMost) {
  std::vector<ComparedResult> arms;
  for (int i = 0; i < 20; ++i) {
    arms.push_back(
        MakeArm("arm" + std::to_string(i), i < 5 ? 1.0 : 8e-3, 1e-3));
  }
  EXPECT_EQ(CompareFleet(arms, 0).sentence,
            "5 of 20 arms are outliers: arm0, arm1, arm2, arm3 and 1 more.");
}

std::vector<ComparedResult> Series(double change) {
  std::vector<ComparedResult> results = {MakeArm("spring", 8e-3, 1e-3),
                                         MakeArm("autumn", 8e-3, 1e-3)};
  AddParameter("d3", 1e-4, 3e-6, &results[0]);
  AddParameter("d3", 1e-4 + change, 4e-6, &results[1]);
  return results;
}

// The standard deviation of the difference is 5 um.
TEST(CompareOverTimeTest, ThresholdIsMetFromBothSides) {
  for (const double sign : {-1.0, 1.0}) {
    const DriftSummary still = CompareOverTime(Series(sign * 14.9999e-6));
    EXPECT_EQ(still.level, FindingLevel::kPassed);
    EXPECT_EQ(still.sentence,
              "No joint parameter changed by more than 3 standard deviations "
              "between spring and autumn.");
    EXPECT_FALSE(still.changes[0].is_significant);
    EXPECT_NEAR(still.changes[0].std, 5e-6, 1e-18);
    const DriftSummary drift = CompareOverTime(Series(sign * 15.0001e-6));
    EXPECT_EQ(drift.level, FindingLevel::kAttention);
    EXPECT_EQ(drift.title, "1 significant change");
    EXPECT_TRUE(drift.changes[0].is_significant);
    EXPECT_NEAR(drift.changes[0].score(), sign * 3.0, 1e-4);
  }
  EXPECT_EQ(CompareOverTime(Series(1e-4)).sentence,
            "One joint parameter changed significantly: d3 by +0.100 mm (20 "
            "standard deviations) from spring to autumn.");
}

TEST(CompareOverTimeTest, UnknownStandardDeviationsAreNoVerdict) {
  std::vector<ComparedResult> results = Series(1e-3);
  results[1].parameters[0].std = kNone;
  DriftSummary drift = CompareOverTime(results);
  EXPECT_EQ(drift.title, "Cannot be determined");
  EXPECT_EQ(drift.level, FindingLevel::kAttention);
  EXPECT_FALSE(drift.changes[0].is_significant);
  results[1].parameters[0].is_free = false;
  EXPECT_TRUE(CompareOverTime(results).changes.empty());
}

TEST(CompareMethodsTest, RanksByErrorAfterCalibration) {
  std::vector<ComparedResult> results = {MakeArm("plain", 8e-3, 1e-3),
                                         MakeArm("robust", 8e-3, 0.5e-3),
                                         MakeArm("rules", 8e-3, 2e-3)};
  MethodSummary methods = CompareMethods(results);
  EXPECT_EQ(methods.ranking, (std::vector<std::size_t>{1, 0, 2}));
  EXPECT_EQ(methods.sentence,
            "robust has the lowest mean error at validation poses, 0.500 mm; "
            "rules has the highest, 2.00 mm.");
  results[0].is_validated = false;
  methods = CompareMethods(results);
  EXPECT_NE(methods.sentence.find("at training poses"), std::string::npos);
}

// A thousand runs of a study are no methods to be ranked.
TEST(CompareMethodsTest, ManyResultsAreRuns) {
  std::vector<ComparedResult> results;
  for (int i = 0; i < 30; ++i) {
    results.push_back(MakeArm(std::to_string(i), 8e-3, 1e-3));
  }
  EXPECT_FALSE(CompareMethods(results).are_runs());
  results.clear();
  // 0.1 to 10.1 mm, in an order of their own.
  for (int i = 0; i < 101; ++i) {
    results.push_back(
        MakeArm(std::to_string(i), 8e-3, 1e-4 * (1 + (37 * i) % 101)));
  }
  const MethodSummary runs = CompareMethods(results);
  EXPECT_TRUE(runs.are_runs());
  EXPECT_EQ(runs.title, "101 runs");
  EXPECT_EQ(runs.sentence,
            "101 runs: after calibration the mean error at validation poses is "
            "5.10 mm in the median run, 0.600 mm to 9.60 mm in 90 % of them.");
}

TEST(DescribeForComparisonTest, TakesJointsAndWhatIsKnownOfThem) {
  CalibrationResult result;
  result.train.after.mean = 1e-3;
  for (const char* kind : {"d", "base", "tool"}) {
    ParameterResult parameter;
    parameter.name = std::string(kind) + "1";
    parameter.kind = kind;
    parameter.decision.predicted_std = 2e-6;
    result.parameters.push_back(parameter);
  }
  ComparedResult compared = DescribeForComparison("arm", result);
  ASSERT_EQ(compared.parameters.size(), 1U);
  EXPECT_EQ(compared.parameters[0].std, 2e-6);
  EXPECT_FALSE(compared.is_validated);
  result.parameters[0].std = 1e-6;
  EXPECT_EQ(DescribeForComparison("arm", result).parameters[0].std, 1e-6);
  result.uncertainty.emplace();
  result.uncertainty->parameters.emplace_back();
  result.uncertainty->parameters[0].name = "d1";
  result.uncertainty->parameters[0].std =
      std::numeric_limits<double>::infinity();
  compared = DescribeForComparison("arm", result);
  EXPECT_TRUE(std::isnan(compared.parameters[0].std));
}

}  // namespace
}  // namespace alidade::internal::comparison_test
