#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/calibration/evaluate.h"
#include "src/job/run_job.h"
#include "src/serialization/job_config.h"
#include "tests/support/edit.h"

namespace alidade::internal::job_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

JobConfig LoadStudy(const std::string& name = "rv2aj_study") {
  return LoadJob(std::string(ALIDADE_SOURCE_DIR) + "/configs/jobs/" + name +
                 ".yaml");
}

const ParameterResult& Find(const CalibrationResult& result,
                            const std::string& name) {
  for (const ParameterResult& parameter : result.parameters) {
    if (parameter.name == name) return parameter;
  }
  throw std::runtime_error("no parameter " + name);
}

TEST(JobTest, StudyReachesItsPublishedFigures) {
  const CalibrationResult outcome = RunJob(LoadStudy(), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const CalibrationResult& result = outcome;
  ASSERT_EQ(result.runs.size(), 2u);
  for (const SolverRun& run : result.runs) {
    EXPECT_EQ(run.summary.status, SolverStatus::kPrecisionLimit);
    // A few units in the last place of 0.4 m.
    EXPECT_LT(run.train.max, 4e-16);
    EXPECT_GT(run.train.max, 2e-17);
  }
  EXPECT_LE(result.runs[0].summary.iterations.size(), 13u);
  EXPECT_LE(result.runs[1].summary.iterations.size(), 7u);
  EXPECT_NEAR(result.train.before.min, 1.955e-3, 0.02e-3);
  EXPECT_NEAR(result.train.before.max, 5.21e-3, 0.005e-3);
  EXPECT_LT(result.validation->after.max, 5e-16);
  EXPECT_EQ(result.validation->after.n, 3600);
}

TEST(JobTest, PublishedValuesStandBesideThoseObtained) {
  const CalibrationResult outcome = RunJob(LoadStudy(), "test");
  EXPECT_EQ(outcome.published_source, "Etalonnage geometrique du robot RV-2AJ");
  const ParameterResult& d4 = Find(outcome, "d4");
  EXPECT_NEAR(d4.published.value(), 0.1601, 1e-15);
  // 0.1 mm + sin(0.004) * 0.1 mm.
  EXPECT_NEAR(d4.deviation(), 0.1e-3 + std::sin(0.004) * 0.1e-3, 1e-11);
  EXPECT_FALSE(Find(outcome, "d1").published.has_value());
}

TEST(JobTest, FlangeReachesTheFloorToo) {
  const CalibrationResult outcome = RunJob(LoadStudy("rv2aj_flange"), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  EXPECT_EQ(outcome.identifiability.num_free, 18);
  EXPECT_LT(outcome.validation->after.max, 5e-16);
  EXPECT_NEAR(Find(outcome, "d4").deviation(),
              0.1e-3 + std::sin(0.004) * 0.1e-3, 1e-11);
}

TEST(JobTest, RankShortWithoutAChoiceIsRefusedWithTheAnalysis) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.options.identifiability.fix.clear();
  const CalibrationResult outcome = RunJob(config, "test");
  EXPECT_EQ(outcome.status, CalibrationStatus::kRefused);
  EXPECT_THAT(outcome.message, HasSubstr("theta4"));
  EXPECT_TRUE(outcome.runs.empty());
  EXPECT_EQ(outcome.identifiability.num_free, 20);
  config.options.identifiability.proceed_beyond_rank = true;
  EXPECT_EQ(RunJob(config, "test").status, CalibrationStatus::kDone);
}

TEST(JobTest, SolverThatCannotSolveIsReportedAndLeavesTheArmNominal) {
  JobConfig config = LoadStudy();
  testing::Edit(&config.data.training.positions()).at(1, 7) =
      std::numeric_limits<double>::quiet_NaN();
  const CalibrationResult outcome = RunJob(config, "test");
  EXPECT_EQ(outcome.status, CalibrationStatus::kFailed);
  EXPECT_THAT(outcome.message, HasSubstr("not finite"));
  EXPECT_EQ(outcome.arm.joints[0].r, config.arm.joints[0].r);
}

TEST(JobTest, ResidualsBeyondTheirSigmasAreAWarning) {
  JobConfig config = LoadStudy();
  EXPECT_THAT(RunJob(config, "test").warnings,
              Not(Contains(HasSubstr("as the sigmas say"))));
  testing::Edit(&config.data.training.positions())->row(2).array() += 0.5e-3;
  testing::Edit(&config.data.training.positions()).at(0, 3) += 5e-3;
  const CalibrationResult outcome = RunJob(config, "test");
  EXPECT_THAT(outcome.warnings, Contains(HasSubstr("sigmas")));
}

// Of x alone, alpha1 and r1 have no effect; positions depend on both.
TEST(JobTest, PositionsThatDependOnWhatIsNotMeasuredAreAWarning) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.options.identifiability.method = IdentifiabilityMethod::kRank;
  EXPECT_THAT(RunJob(config, "test").warnings,
              Not(Contains(HasSubstr("positions depend on"))));
  testing::Edit(&config.data.training.sigmas())
      ->bottomRows(2)
      .setConstant(std::numeric_limits<double>::infinity());
  EXPECT_THAT(RunJob(config, "test").warnings,
              Contains(AllOf(HasSubstr("positions depend on"),
                             HasSubstr("alpha1"), HasSubstr("r1"))));
}

TEST(JobTest, ProfilesThatCannotBeMadeAreAWarning) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.options.uncertainty.intervals = IntervalMethod::kProfile;
  EXPECT_THAT(RunJob(config, "test").warnings,
              Not(Contains(HasSubstr("intervals are linear"))));
  config.options.solver = SolverName::kPseudoInverse;
  config.options.compare_with.clear();
  EXPECT_THAT(RunJob(config, "test").warnings,
              Contains(HasSubstr("intervals are linear: profiles need")));
}

TEST(JobTest, DefaultMethodWarnsOfParametersFarFromTheirPriors) {
  JobConfig config = LoadStudy();
  config.options.identifiability.method = IdentifiabilityMethod::kRank;
  EXPECT_THAT(RunJob(config, "test").warnings,
              Not(Contains(HasSubstr("further from nominal"))));
  config.options.identifiability.priors.d = 1e-6;
  const CalibrationResult outcome = RunJob(config, "test");
  EXPECT_THAT(outcome.warnings, Contains(HasSubstr("further from nominal")));
}

TEST(JobTest, LimitsDecideTheStatus) {
  JobConfig config = LoadStudy();
  config.options.acceptance.validation_rms = 1e-18;
  const CalibrationResult outcome = RunJob(config, "test");
  EXPECT_EQ(outcome.status, CalibrationStatus::kMissedLimits);
  EXPECT_FALSE(outcome.accepted());
}

TEST(CompareArmsTest, DistanceOfAShiftedBaseIsTheShiftEverywhere) {
  const Arm arm = LoadStudy().arm;
  Arm shifted = arm;
  shifted.instrument_from_base.translation() = Eigen::Vector3d(0.0, 3e-3, 4e-3);
  const Accuracy accuracy = CompareArms(arm, shifted, 100, 1);
  EXPECT_EQ(accuracy.n, 100);
  EXPECT_NEAR(accuracy.min, 5e-3, 1e-15);
  EXPECT_NEAR(accuracy.max, 5e-3, 1e-15);
}

// A joint that counts backwards from another zero is the same arm; a zero that
// is off is as good as one in the geometry.
TEST(CompareArmsTest, ArmsAreGivenTheSameCommands) {
  Arm arm = LoadStudy().arm;
  const Arm plain = arm;
  arm.motor_offsets = Eigen::VectorXd::Zero(5);
  arm.motor_offsets[1] = 2e-3;
  Arm turned = plain;
  turned.joints[1].theta += 2e-3;
  EXPECT_LT(CompareArms(arm, turned, 100, 1).max, 1e-15);
  EXPECT_NEAR(CompareArms(arm, plain, 100, 1).rms,
              CompareArms(turned, plain, 100, 1).rms, 1e-5);
  EXPECT_GT(CompareArms(arm, plain, 100, 1).rms, 1e-4);
}

}  // namespace
}  // namespace alidade::internal::job_test
