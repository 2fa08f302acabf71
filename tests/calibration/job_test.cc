#include "src/calibration/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "alidade/parameter_layout.h"
#include "alidade/units.h"
#include "src/calibration/evaluate.h"
#include "src/serialization/job_file.h"
#include "tests/support/edit.h"

namespace alidade::internal {
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
  const JobOutcome outcome = RunJob(LoadStudy(), "test", 2);
  ASSERT_EQ(outcome.status, JobStatus::kDone) << outcome.message;
  const CalibrationResult& result = outcome.result;
  ASSERT_EQ(result.runs.size(), 2u);
  for (const SolverRun& run : result.runs) {
    EXPECT_EQ(run.summary.status, SolverStatus::kRoundingFloor);
    // A few units in the last place of 0.4 m.
    EXPECT_LT(run.train.max, 4e-16);
    EXPECT_GT(run.train.max, 2e-17);
  }
  EXPECT_LE(result.runs[0].summary.iterations.size(), 13u);
  EXPECT_LE(result.runs[1].summary.iterations.size(), 7u);
  EXPECT_NEAR(result.train.before.min, 1.955e-3, 0.02e-3);
  EXPECT_NEAR(result.train.before.max, 5.21e-3, 0.005e-3);
  EXPECT_LT(result.heldout->after.max, 5e-16);
  EXPECT_EQ(result.heldout->after.n, 3600);
}

TEST(JobTest, D4TakesUpTheFrozenR4) {
  const JobOutcome outcome = RunJob(LoadStudy(), "test", 1);
  const ParameterResult& d4 = Find(outcome.result, "d4");
  // 0.1 mm + sin(0.004) * 0.1 mm.
  EXPECT_NEAR(d4.deviation(), 0.1e-3 + std::sin(0.004) * 0.1e-3, 1e-11);
  const StudyResult& study = *outcome.result.study;
  ASSERT_EQ(study.absorptions.size(), 1u);
  EXPECT_EQ(study.absorptions[0].frozen, "r4");
  EXPECT_EQ(study.absorptions[0].taken_up_by, "d4");
  EXPECT_NEAR(study.absorptions[0].coefficient, std::sin(0.004), 1e-7);
}

TEST(JobTest, TableAsPrintedIsFourTenthsOfAMicrometreOffEverywhere) {
  const JobOutcome outcome = RunJob(LoadStudy(), "test", 1);
  const StudyResult& study = *outcome.result.study;
  EXPECT_NEAR(study.as_printed.min, 4.0000e-7, 0.5e-11);
  EXPECT_NEAR(study.as_printed.max, 4.0000e-7, 0.5e-11);
  EXPECT_NEAR(study.three_more_decimals.mean, 8.0e-10, 0.1e-10);
  EXPECT_EQ(study.timed_iterations, 100);
  EXPECT_GT(study.timed_s, 0.0);
}

TEST(JobTest, FlangeReachesTheFloorToo) {
  const JobOutcome outcome = RunJob(LoadStudy("rv2aj_flange"), "test", 1);
  ASSERT_EQ(outcome.status, JobStatus::kDone) << outcome.message;
  EXPECT_EQ(outcome.result.identifiability.num_free, 18);
  EXPECT_LT(outcome.result.heldout->after.max, 5e-16);
  EXPECT_NEAR(Find(outcome.result, "d4").deviation(),
              0.1e-3 + std::sin(0.004) * 0.1e-3, 1e-11);
}

TEST(JobTest, RankShortWithoutAChoiceIsRefusedWithTheAnalysis) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.identifiability.fix.clear();
  const JobOutcome outcome = RunJob(config, "test", 1);
  EXPECT_EQ(outcome.status, JobStatus::kRefused);
  EXPECT_THAT(outcome.message, HasSubstr("theta4"));
  EXPECT_TRUE(outcome.result.runs.empty());
  EXPECT_EQ(outcome.result.identifiability.num_free, 20);
  config.identifiability.proceed_beyond_rank = true;
  EXPECT_EQ(RunJob(config, "test", 1).status, JobStatus::kDone);
}

TEST(JobTest, SolverThatCannotSolveIsReportedAndLeavesTheArmNominal) {
  JobConfig config = LoadStudy();
  testing::Edit (&config.data.positions())(1, 7) =
      std::numeric_limits<double>::quiet_NaN();
  const JobOutcome outcome = RunJob(config, "test", 1);
  EXPECT_EQ(outcome.status, JobStatus::kFailed);
  EXPECT_THAT(outcome.message, HasSubstr("not finite"));
  EXPECT_EQ(outcome.calibrated.joints[0].r, config.arm.joints[0].r);
}

TEST(JobTest, ResidualsBeyondTheirSigmasAreAWarning) {
  JobConfig config = LoadStudy();
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Not(Contains(HasSubstr("as the sigmas say"))));
  testing::Edit(&config.data.positions())->row(2).array() += 0.5e-3;
  testing::Edit (&config.data.positions())(0, 3) += 5e-3;
  const JobOutcome outcome = RunJob(config, "test", 1);
  EXPECT_THAT(outcome.result.warnings, Contains(HasSubstr("sigmas")));
}

// Of x alone, alpha1 and r1 have no effect; positions depend on both.
TEST(JobTest, PositionsThatDependOnWhatIsNotMeasuredAreAWarning) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.identifiability.method = IdentifiabilityMethod::kRank;
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Not(Contains(HasSubstr("positions depend on"))));
  testing::Edit(&config.data.sigmas())
      ->bottomRows(2)
      .setConstant(std::numeric_limits<double>::infinity());
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Contains(AllOf(HasSubstr("positions depend on"),
                             HasSubstr("alpha1"), HasSubstr("r1"))));
}

TEST(JobTest, ProfilesThatCannotBeMadeAreAWarning) {
  JobConfig config = LoadStudy("rv2aj_flange");
  config.uncertainty.intervals = IntervalMethod::kProfile;
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Not(Contains(HasSubstr("intervals are linear"))));
  config.solver = SolverName::kPseudoInverse;
  config.compare_with.clear();
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Contains(HasSubstr("intervals are linear: profiles need")));
}

TEST(JobTest, DefaultMethodWarnsOfParametersFarFromTheirPriors) {
  JobConfig config = LoadStudy();
  config.identifiability.method = IdentifiabilityMethod::kRank;
  EXPECT_THAT(RunJob(config, "test", 1).result.warnings,
              Not(Contains(HasSubstr("further from nominal"))));
  config.identifiability.priors.d = 1e-6;
  const JobOutcome outcome = RunJob(config, "test", 1);
  EXPECT_THAT(outcome.result.warnings,
              Contains(HasSubstr("further from nominal")));
}

TEST(JobTest, LimitsDecideTheStatus) {
  JobConfig config = LoadStudy();
  config.acceptance.heldout_rms = 1e-18;
  const JobOutcome outcome = RunJob(config, "test", 1);
  EXPECT_EQ(outcome.status, JobStatus::kMissedLimits);
  EXPECT_FALSE(outcome.result.accepted());
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

}  // namespace
}  // namespace alidade::internal
