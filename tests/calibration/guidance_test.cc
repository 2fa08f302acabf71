#include "src/calibration/guidance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "src/calibration/improvement.h"
#include "src/calibration/verdict.h"
#include "tests/report/report_test_util.h"

namespace alidade::internal::guidance_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeMixedSet;
using testing::MakeResult;
using ::testing::Not;

std::vector<Finding> FindingsOf(const CalibrationResult& result,
                                const std::string& key) {
  std::vector<Finding> found;
  for (const Finding& finding : GuidanceOf(result)) {
    if (finding.key == key) found.push_back(finding);
  }
  return found;
}

// A joint that turns and one that slides, the base a metre from the instrument,
// and a map of two configurations.
CalibrationResult MakeMapped() {
  CalibrationResult result = MakeResult();
  result.arm.joints.resize(2);
  result.arm.joints[0].type = JointType::kRevolute;
  result.arm.joints[0].lower = 0.0;
  result.arm.joints[0].upper = kPi;
  result.arm.joints[1].type = JointType::kPrismatic;
  result.arm.joints[1].lower = 0.0;
  result.arm.joints[1].upper = 0.1;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.translation() << 1.0, 2.0, 0.0;
  result.arm.instrument_from_base = base;
  PredictedMap& map = result.uncertainty.emplace().workspace.emplace();
  map.joint_values.resize(2, 2);
  map.joint_values << 0.5, 0.25 * kPi, 0.01, 0.05;
  map.positions.resize(3, 2);
  map.positions << 1.5, 1.312, 2.0, 1.96, 0.1, 0.905;
  map.position_std = Eigen::Vector2d(1e-4, 3e-4);
  map.summary = SummarizeErrors(map.position_std);
  map.parts.from_parameters = 1e-4;
  result.validation->after = SummarizeErrors(Eigen::Vector2d(1e-4, 4e-4));
  return result;
}

TEST(GuidanceTest, WorstPlaceIsInTheFrameOfTheBase) {
  const CalibrationResult result = MakeMapped();
  const std::vector<Finding> found = FindingsOf(result, "worst_place");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].statistic, 3e-4);
  EXPECT_THAT(found[0].sentence,
              HasSubstr("x, y, z = 312, -40, 905 mm in the frame of its base "
                        "(joints at 45 deg, 50 mm): a standard deviation of "
                        "0.300 mm, 1.5 times the median."));
}

TEST(GuidanceTest, NoPlaceIsWorstWhereAllAreTheSame) {
  CalibrationResult result = MakeMapped();
  PredictedMap& map = *result.uncertainty->workspace;
  map.position_std = Eigen::Vector2d(3e-4, 3.01e-4);
  map.summary = SummarizeErrors(map.position_std);
  EXPECT_THAT(FindingsOf(result, "worst_place").at(0).sentence,
              HasSubstr("the same over the whole workspace, 0.301 mm."));
}

TEST(GuidanceTest, WorstMeasurementIsOneThatWasKept) {
  CalibrationResult result = MakeMapped();
  EvaluatedSet& set = *result.validation;
  Eigen::MatrixXd after = Eigen::MatrixXd::Zero(3, 20);
  after(0, 7) = 4e-4;
  after(0, 3) = 5e-3;  // rejected
  set.residual_after = after;
  set.after = SummarizeErrors(set.ErrorAfter());
  set.kept.emplace().num_rejected = 1;
  set.kept->after = SummarizeErrors(Eigen::Vector2d(1e-4, 4e-4));
  EXPECT_THAT(FindingsOf(result, "worst_place").at(0).sentence,
              HasSubstr("0.400 mm, was measured at"));
  EXPECT_THAT(FindingsOf(result, "worst_place").at(0).sentence,
              HasSubstr("(validation pose 8)."));
  EXPECT_THAT(FindingsOf(result, "accuracy").at(0).sentence,
              HasSubstr("all within 0.400 mm"));
}

TEST(GuidanceTest, AStatedRegionHasItsOwnAccuracy) {
  CalibrationResult result = MakeMapped();
  UncertaintyBudget& budget = result.uncertainty->budget.emplace();
  budget.position.expanded_distance = 0.123e-3;
  budget.worst_std = 0.045e-3;
  EXPECT_THAT(FindingsOf(result, "accuracy").at(0).sentence,
              ::testing::Not(HasSubstr("task region")));
  budget.region.resize(1);
  EXPECT_THAT(FindingsOf(result, "accuracy").at(0).sentence,
              HasSubstr("95.0 % of positions are within 0.123 mm of where the "
                        "calibrated arm says, and no coordinate has a standard "
                        "uncertainty above 0.0450 mm."));
}

TEST(GuidanceTest, JointsThatHardlyMovedAreNamed) {
  CalibrationResult result = MakeMapped();
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(2, 3);
  values.row(0) << 0.0, 0.5 * kPi, 0.25 * kPi;
  values.row(1) << 0.0, 0.07, 0.01;
  result.train.joint_values = values;
  const Finding finding = FindingsOf(result, "next_measurement").at(0);
  EXPECT_EQ(finding.sentence,
            "Only a part of the range was measured of joint 1 (50 %).");
  EXPECT_NEAR(finding.statistic, 0.5, 1e-12);
}

// A whole turn is what a joint without limits may be asked to do.
TEST(GuidanceTest, JointsWithoutLimitsAreComparedWithAWholeTurn) {
  CalibrationResult result = MakeMapped();
  Joint& joint = result.arm.joints[0];
  joint.lower = -std::numeric_limits<double>::infinity();
  joint.upper = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd values(2, 2);
  values << -0.5, 0.5, 0.0, 0.1;
  result.train.joint_values = values;
  const std::vector<Finding> found = FindingsOf(result, "next_measurement");
  ASSERT_FALSE(found.empty());
  EXPECT_THAT(found[0].sentence,
              HasSubstr("joint 1 (16 %), of a whole turn where"));
  EXPECT_THAT(FindingsOf(result, "accuracy")[0].sentence,
              HasSubstr("workspace (whole turns of joints"));
}

// What the folds left out says more of other poses than what was fitted.
TEST(GuidanceTest, AccuracyIsThatOfTheFoldsWithoutValidation) {
  CalibrationResult result = MakeMapped();
  CrossValidation& folds = result.cross_validation.emplace();
  folds.folds = 5;
  folds.position = SummarizeErrors(Eigen::Vector2d(3e-4, 7e-4));
  EXPECT_THAT(FindingsOf(result, "accuracy")[0].sentence,
              HasSubstr("At validation poses"));
  result.validation.reset();
  EXPECT_THAT(FindingsOf(result, "accuracy")[0].sentence,
              AllOf(HasSubstr("left out of the fit in turn"),
                    HasSubstr("all within 0.700 mm")));
}

TEST(GuidanceTest, SaysWhetherMorePosesHelp) {
  CalibrationResult result = MakeMapped();
  EXPECT_THAT(FindingsOf(result, "next_measurement").back().sentence,
              HasSubstr("nothing from what the model lacks: four times as many "
                        "poses would halve the former"));
  PredictedMap& map = *result.uncertainty->workspace;
  map.parts.from_model = 1.1e-4;
  const Finding lacking = FindingsOf(result, "next_measurement").back();
  EXPECT_THAT(lacking.sentence, HasSubstr("hardly help"));
  EXPECT_THAT(lacking.next, HasSubstr("`errors: auto`"));
  EXPECT_NEAR(lacking.statistic, 1.1, 1e-12);
  map.summary = SummarizeErrors(Eigen::Vector2d(0.01, 0.02));
  EXPECT_THAT(FindingsOf(result, "next_measurement").back().next,
              HasSubstr("only where it was measured"));
}

TEST(GuidanceTest, WithoutValidationItIsAskedFor) {
  CalibrationResult result = MakeMapped();
  result.validation.reset();
  EXPECT_THAT(FindingsOf(result, "next_measurement").at(0).next,
              HasSubstr("`validation`"));
  EXPECT_THAT(FindingsOf(result, "accuracy").at(0).sentence,
              HasSubstr("At training poses"));
}

TEST(GuidanceTest, DecidesNothing) {
  CalibrationResult result = MakeMapped();
  JudgeResult(&result);
  EXPECT_EQ(result.verdict.title, "Accepted");
  for (const Finding& finding : GuidanceOf(result)) {
    EXPECT_EQ(finding.level, FindingLevel::kPassed) << finding.sentence;
  }
  EXPECT_THAT(GuidanceOf(CalibrationResult()), Not(IsEmpty()));
}

TEST(NamesTest, LengthsAreCalledLengths) {
  EvaluatedSet set = MakeMixedSet();
  EXPECT_STREQ(LengthErrorName(set), "position error");
  EXPECT_EQ(ObservationName(set, "training"), "training observation");
  set.labels = {{"distance", 0, "", ""}, {"plane", 1, "", ""}};
  EXPECT_STREQ(LengthErrorName(set), "length error");
  EXPECT_EQ(ObservationName(set, "training"), "training pose");
  set.labels.clear();
  EXPECT_STREQ(LengthErrorName(set), "position error");
}

}  // namespace
}  // namespace alidade::internal::guidance_test
