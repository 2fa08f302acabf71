#include "alidade/monte_carlo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "src/serialization/job_config.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

constexpr double kSigma = 0.02e-3;

JobConfig FlangeJob(int trials) {
  JobConfig config;
  config.title = "flange";
  config.arm = testing::Rv2ajFlange();
  config.data.training = testing::NoisyPositions(config.arm, 56, kSigma, 7);
  config.options.identifiability.policy = WeakPolicy::kFreeze;
  config.montecarlo.trials = trials;
  config.montecarlo.workspace_poses = 20;
  return config;
}

MonteCarloResult Study(JobConfig job, int num_threads) {
  job.options.num_threads = num_threads;
  return RunMonteCarlo(job.arm, job.data, job.options, job.montecarlo);
}

double MeanCoverage(const MonteCarloResult& result) {
  double sum = 0.0;
  for (const SimulatedParameter& one : result.parameters) {
    sum += one.coverage.rate();
  }
  return sum / static_cast<double>(result.parameters.size());
}

TEST(MonteCarloTest, TrialsDoNotDependOnThreadsOrOnTheirNumber) {
  const MonteCarloResult one = Study(FlangeJob(12), 1);
  const MonteCarloResult three = Study(FlangeJob(20), 3);
  for (std::size_t k = 0; k < one.trials.size(); ++k) {
    EXPECT_EQ(one.trials[k].estimates, three.trials[k].estimates);
    EXPECT_EQ(one.trials[k].workspace_rms, three.trials[k].workspace_rms);
  }
  EXPECT_NE(one.trials[0].estimates, one.trials[1].estimates);
}

// 300 trials of 18 parameters: the mean rate is known to some 0.7 %.
TEST(MonteCarloTest, IntervalsHoldAsOftenAsTheySay) {
  for (const bool estimated : {false, true}) {
    JobConfig config = FlangeJob(300);
    config.options.estimate_sigma = estimated;
    const MonteCarloResult result = Study(config, 2);
    ASSERT_EQ(result.failed, 0);
    ASSERT_EQ(result.parameters.size(), 18u);
    EXPECT_NEAR(MeanCoverage(result), 0.95, 0.015);
    EXPECT_NEAR(result.axes.rate(), 0.95, 0.02);
    EXPECT_NEAR(result.ellipsoids.rate(), 0.95, 0.025);
    // As efficient as can be; 300 trials tell a spread to 4 %.
    EXPECT_NEAR(result.inefficiency, 1.0, 0.05);
    EXPECT_NEAR(result.workspace.rms / result.workspace_predicted, 1.0, 0.05);
  }
}

// Intervals made for another confidence: the rates follow it.
TEST(MonteCarloTest, RatesFollowTheConfidence) {
  JobConfig config = FlangeJob(200);
  config.options.uncertainty.confidence = 0.5;
  const MonteCarloResult result = Study(config, 2);
  EXPECT_NEAR(MeanCoverage(result), 0.5, 0.04);
}

TEST(MonteCarloTest, RobustLossWithstandsOutliers) {
  JobConfig config = FlangeJob(150);
  config.montecarlo.outlier_fraction = 0.05;
  config.montecarlo.outlier_size = 1e-3;
  const double squares = Study(config, 2).inefficiency;
  config.options.loss = LossKind::kTukey;
  const double robust = Study(config, 2).inefficiency;
  // Variance 1 + 0.05 * 50^2 times that without outliers.
  EXPECT_NEAR(squares, std::sqrt(126.0), 2.5);
  // 5 % of the data lost and 95 % efficient: 1.05; 150 trials tell it to 6 %.
  EXPECT_NEAR(robust, 1.05, 0.1);
}

TEST(MonteCarloTest, TruthDrawnFromThePriorsIsHeldByThePosterior) {
  JobConfig config = FlangeJob(300);
  config.options.identifiability.policy = WeakPolicy::kPrior;
  config.montecarlo.truth = SimulatedTruth::kPriors;
  const MonteCarloResult result = Study(config, 2);
  EXPECT_NEAR(MeanCoverage(result), 0.95, 0.02);
  EXPECT_NEAR(result.ellipsoids.rate(), 0.95, 0.03);
}

// Rotations of a fitted base, which joints that are drawn take with them: of
// 150 trials each interval holds 95 +- 1.8 %, here at four sigmas.
TEST(MonteCarloTest, RotationsOfTheBaseAreHeldToo) {
  JobConfig config = FlangeJob(150);
  config.options.identifiability.policy = WeakPolicy::kPrior;
  config.options.identifiability.candidates.base = true;
  config.montecarlo.truth = SimulatedTruth::kPriors;
  const MonteCarloResult result = Study(config, 2);
  int rotations = 0;
  for (const SimulatedParameter& one : result.parameters) {
    if (one.name.rfind("base_r", 0) != 0) continue;
    ++rotations;
    EXPECT_NEAR(one.coverage.rate(), 0.95, 0.072) << one.name;
  }
  EXPECT_GE(rotations, 2);
}

TEST(MonteCarloTest, StopsWhereTheMeanErrorIsKnownWellEnough) {
  JobConfig config = FlangeJob(100000);
  config.montecarlo.precision = 0.05;
  const MonteCarloResult result = Study(config, 2);
  EXPECT_TRUE(result.stopped_early);
  EXPECT_EQ(result.trials.size(), 256u);
}

// A fixed parameter that is off: what depends on it takes it up, and that
// counts as the truth.
TEST(MonteCarloTest, TruthIsWhatExactMeasurementsWouldGive) {
  JobConfig config = FlangeJob(100);
  config.options.true_values =
      ParameterLayout(5).Values(testing::WithRv2ajDeviations(config.arm));
  config.montecarlo.truth = SimulatedTruth::kGiven;
  const MonteCarloResult result = Study(config, 2);
  EXPECT_NEAR(MeanCoverage(result), 0.95, 0.03);
  for (const SimulatedParameter& one : result.parameters) {
    if (one.name != "r2") continue;
    // r2 takes up r3 and r4: 1 - 0.1 + 0.1 mm, and terms of second order.
    EXPECT_NEAR(one.truth, 1.0e-3, 0.02e-3);
  }
}

TEST(MonteCarloTest, ContactsAreRefused) {
  JobConfig config = FlangeJob(10);
  config.data.training.name = "balls.csv";
  config.data.training.blocks[0].kind = MeasurementKind::kFixedPoint;
  EXPECT_THROW(Study(config, 1), InputError);
}

}  // namespace
}  // namespace alidade::internal
