#include "alidade/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "alidade/dataset_file.h"
#include "alidade/error.h"
#include "src/common/files.h"
#include "src/dataio/dataset_csv.h"
#include "src/job/run_job.h"
#include "src/serialization/plan_file.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal {
namespace {

PlanConfig FlangePlan() {
  PlanConfig config = LoadPlan(std::string(ALIDADE_SOURCE_DIR) +
                               "/configs/plans/rv2aj_flange.yaml");
  config.candidates.count = 600;
  config.design.num_poses = 12;
  config.design.starts = 1;
  config.with_curve = false;
  return config;
}

std::string ContentOf(const std::vector<ReportFile>& files,
                      const std::string& name) {
  for (const ReportFile& file : files) {
    if (file.name == name) return file.Text();
  }
  return "";
}

TEST(RunPlanTest, FindsTheStudysParametersAndAlpha4) {
  const PlanResult result = RunPlan(FlangePlan(), "test");
  ASSERT_EQ(result.status, PlanStatus::kDone) << result.message;
  EXPECT_EQ(result.parameters.size(), 18U);
  EXPECT_EQ(result.joint_values.cols(), 12);
  EXPECT_NEAR(result.bound, 2e-5 * std::sqrt(18.0 / 12.0), 1e-18);
  ASSERT_EQ(result.evaluations.size(), 3U);
  const PlanEvaluation& planned = result.evaluations[0];
  const PlanEvaluation& random = result.evaluations[2];
  EXPECT_GE(planned.candidates.worst, result.bound);
  EXPECT_LT(planned.region.worst, random.region.worst);
  EXPECT_LT(planned.region.rms, random.region.rms);
  EXPECT_GT(planned.observability.o1, random.observability.o1);
  // At least what the plan's own slope bounds, which where nothing is known
  // before is that of the variance.
  EXPECT_GE(
      result.d_efficiency,
      std::exp(1.0 - std::pow(planned.candidates.worst / result.bound, 2.0)));
  EXPECT_LE(result.d_efficiency, 1.0);
  EXPECT_LT(result.travel, result.travel_before);
}

// The sheet is a data set in which nothing is measured; `simulate` and the
// robot read the planned joint values from it, to the bit.
TEST(RunPlanTest, SheetHoldsThePlannedJointValues) {
  const PlanResult result = RunPlan(FlangePlan(), "test");
  const TestDirectory directory;
  const std::string path =
      directory.Write("poses.csv", ContentOf(RenderPlan(result), "poses.csv"));
  EXPECT_EQ(LoadJointValues(path, result.planned_arm), result.joint_values);
}

TEST(RunPlanTest, ThreadsChangeNothing) {
  PlanConfig config = FlangePlan();
  config.with_curve = true;
  config.curve = {9, 14};
  const std::vector<ReportFile> one = RenderPlan(RunPlan(config, "test"));
  config.job.options.num_threads = 3;
  const std::vector<ReportFile> three = RenderPlan(RunPlan(config, "test"));
  for (const char* name :
       {"poses.csv", "plan.txt", "accuracy.svg", "curve.csv"}) {
    EXPECT_NE(ContentOf(one, name), "") << name;
    EXPECT_EQ(ContentOf(one, name), ContentOf(three, name)) << name;
  }
}

// Poses measured already tell what need not be measured again.
TEST(RunPlanTest, EarlierPosesCount) {
  PlanConfig config = FlangePlan();
  config.design.num_poses = 8;
  const double alone = RunPlan(config, "test").evaluations[0].region.worst;
  config.job.data.training = LoadDataset(
      std::string(ALIDADE_SOURCE_DIR) + "/datasets/rv2aj/flange_56.csv",
      config.job.arm, 2e-5);
  const PlanResult result = RunPlan(config, "test");
  ASSERT_EQ(result.status, PlanStatus::kDone) << result.message;
  EXPECT_EQ(result.measured_before, 56);
  EXPECT_EQ(result.bound, 0.0);
  ASSERT_EQ(result.evaluations.size(), 4U);
  EXPECT_LT(result.evaluations[0].region.worst, alone);
  EXPECT_LT(result.evaluations[0].region.worst,
            result.evaluations[3].region.worst);
}

TEST(RunPlanTest, FindsHowManyPosesAnAccuracyNeeds) {
  PlanConfig config = FlangePlan();
  config.wanted = 2e-5;
  config.design.num_poses = 100;
  const PlanResult result = RunPlan(config, "test");
  ASSERT_EQ(result.status, PlanStatus::kDone) << result.message;
  // sigma sqrt(18 / N) is 0.02 mm at 18: no plan of 17 poses is enough.
  const auto number = result.joint_values.cols();
  EXPECT_GE(number, 18);
  EXPECT_LE(number, 25);
  // The choice at last is among more candidates than the search looks at.
  config.candidates.count = 3000;
  for (const double wanted :
       {2.0e-5, 1.9e-5, 1.8e-5, 1.7e-5, 1.6e-5, 1.5e-5, 1.4e-5, 1.3e-5}) {
    config.wanted = wanted;
    const PlanResult met = RunPlan(config, "test");
    ASSERT_EQ(met.status, PlanStatus::kDone) << met.message;
    EXPECT_LE(met.evaluations[0].region.worst, wanted);
    EXPECT_LE(met.joint_values.cols(),
              1.4 * 18.0 * (2e-5 / wanted) * (2e-5 / wanted));
  }

  config.design.num_poses = 15;
  const PlanResult refused = RunPlan(config, "test");
  EXPECT_EQ(refused.status, PlanStatus::kRefused);
  EXPECT_NE(refused.message.find("needs more than 15 poses"), std::string::npos)
      << refused.message;
}

TEST(RunPlanTest, TooFewPosesForTheParametersFail) {
  PlanConfig config = FlangePlan();
  config.design.num_poses = 5;
  const PlanResult result = RunPlan(config, "test");
  EXPECT_EQ(result.status, PlanStatus::kFailed);
  EXPECT_NE(result.message.find("do not determine 18 parameters"),
            std::string::npos)
      << result.message;
}

// An instrument that stands elsewhere measures the same of the joints, and
// scales of angles are those of the arm: criteria that compare parameters have
// the same value to rounding, which at 100 km is 1e-11 of the arm's lengths.
TEST(RunPlanTest, DistanceOfTheInstrumentChangesNoPlan) {
  PlanConfig config = FlangePlan();
  config.candidates.count = 200;
  for (const DesignCriterion criterion :
       {DesignCriterion::kA, DesignCriterion::kE, DesignCriterion::kD}) {
    config.design.criterion = criterion;
    config.job.arm.instrument_from_base = Eigen::Isometry3d::Identity();
    const PlanResult near = RunPlan(config, "test");
    ASSERT_EQ(near.status, PlanStatus::kDone) << near.message;
    for (const double distance : {3.0, 1e5}) {
      config.job.arm.instrument_from_base.translation().x() = distance;
      const PlanResult far = RunPlan(config, "test");
      ASSERT_EQ(far.status, PlanStatus::kDone) << far.message;
      EXPECT_NEAR(far.value, near.value, 1e-6) << distance;
    }
  }
}

// With z alone no pose tells, for instance, d2, and more poses would not.
TEST(RunPlanTest, WhatNoNumberOfPosesTellsIsNotAskedFor) {
  PlanConfig config = FlangePlan();
  config.measurement.axes = {false, false, true};
  config.design.num_poses = 200;
  const PlanResult result = RunPlan(config, "test");
  EXPECT_EQ(result.status, PlanStatus::kFailed);
  EXPECT_NE(
      result.message.find("all 600 candidates together determine only 9 of "
                          "16 parameters"),
      std::string::npos)
      << result.message;
  EXPECT_EQ(result.message.find("plan more poses"), std::string::npos);
}

TEST(RunPlanTest, ConstraintsThatNoPoseMeetsAreAnErrorOfTheUser) {
  PlanConfig config = FlangePlan();
  config.candidates.count = 50;
  config.candidates.max_draws = 10;
  // A thousandth of a millimetre wide.
  const WorkspaceBox tiny{{0.3, 0.1, 0.4}, {0.300001, 0.100001, 0.400001}};
  config.constraints.boxes = {tiny};
  ExpectInputError([&] { RunPlan(config, "test"); },
                   {0, 0, "candidates", "none of 500 poses"});
  config.constraints.boxes.clear();
  config.candidates.max_draws = 1;
  config.region.boxes = {tiny};
  ExpectInputError([&] { RunPlan(config, "test"); },
                   {0, 0, "region", "no pose within these joint limits"});
}

// No draw is made: ten million of them would take long.
TEST(RunPlanTest, BoxesThatTheArmCannotReachAreRefused) {
  const WorkspaceBox far{{5.0, 5.0, 5.0}, {6.0, 6.0, 6.0}};
  PlanConfig config = FlangePlan();
  config.region.boxes = {far};
  ExpectInputError([&] { RunPlan(config, "test"); },
                   {0, 0, "region", "all boxes are farther from the base"});
  // Poses that are given are looked at all the same.
  config.constraints.boxes = {far};
  config.region.boxes.clear();
  config.given_candidates = Eigen::MatrixXd::Zero(5, 3);
  ExpectInputError([&] { RunPlan(config, "test"); },
                   {0, 0, "candidates", "none of 3 poses"});
  config = FlangePlan();
  config.constraints.boxes = {far};
  ExpectInputError([&] { RunPlan(config, "test"); },
                   {0, 0, "candidates", "all boxes are farther from the base"});
}

}  // namespace
}  // namespace alidade::internal
