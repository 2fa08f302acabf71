#include "src/simulation/noise_study.h"

#include <gtest/gtest.h>

#include <string>

#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

JobConfig LoadNoiseJob(int trials) {
  JobConfig config = LoadJob(std::string(ALIDADE_SOURCE_DIR) +
                             "/configs/jobs/rv2aj_noise.yaml");
  config.noise_study->trials = trials;
  config.noise_study->workspace_poses = 500;
  return config;
}

double Median(const Eigen::VectorXd& values) {
  return NoiseStudyMethod::Percentile(values, 0.5);
}

NoiseStudyResult Study(int trials, int num_threads) {
  JobConfig job = LoadNoiseJob(trials);
  job.options.num_threads = num_threads;
  return RunNoiseStudy(job, *job.noise_study);
}

TEST(NoiseStudyTest, PublishedProcedureIsWorseThanNoneAndTheDefaultIsNot) {
  const NoiseStudyResult study = Study(60, 2);
  ASSERT_EQ(study.methods.size(), 3u);
  const NoiseStudyMethod& published = study.methods[0];
  const NoiseStudyMethod& standard = study.methods[1];
  EXPECT_NEAR(study.workspace_rms_before, 5.5e-3, 0.2e-3);
  // Both fit the plane to sigma * sqrt(rank / poses): 0.0103 to 0.011 mm.
  EXPECT_NEAR(Median(published.data_rms), 0.011e-3, 0.0015e-3);
  EXPECT_NEAR(Median(standard.data_rms), 0.0103e-3, 0.0015e-3);
  // 39 mm over 1000 trials, with 4 to 134 mm between the 5th and the 95th
  // percentile: the median of 60 lies well within these.
  EXPECT_GT(Median(published.workspace_rms), 20e-3);
  EXPECT_LT(Median(published.workspace_rms), 80e-3);
  EXPECT_LT(Median(standard.workspace_rms), 0.3e-3);
  EXPECT_GT(Median(standard.workspace_rms), 0.15e-3);
  EXPECT_LT(NoiseStudyMethod::Percentile(standard.workspace_rms, 0.95), 0.8e-3);
  EXPECT_EQ(standard.failed, 0);
}

TEST(NoiseStudyTest, TrialsDoNotDependOnThreads) {
  const NoiseStudyResult one = Study(8, 1);
  const NoiseStudyResult three = Study(8, 3);
  for (std::size_t m = 0; m < one.methods.size(); ++m) {
    EXPECT_EQ(one.methods[m].workspace_rms, three.methods[m].workspace_rms);
    EXPECT_EQ(one.methods[m].data_rms, three.methods[m].data_rms);
  }
}

}  // namespace
}  // namespace alidade::internal
