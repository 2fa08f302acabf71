// Real measurements that are no part of the project: skipped, with a message,
// where they are absent.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>

#include "alidade/batch/job.h"
#include "alidade/io/job_file.h"

namespace alidade {
namespace {

std::string DataDirectory() {
  if (const char* given = std::getenv("ALIDADE_DATA")) return given;
  return std::string(ALIDADE_SOURCE_DIR) + "/../shared/data";
}

// Mean error on held-out poses (mm) that one split leaves. A plain
// least-squares fit by another program (scipy, weak priors) reached `plain` on
// splits of its own; splits of small sets differ by some 20 % of it.
struct RealArm {
  std::string job;
  int rank;
  double plain;
  double tolerance;
};

void PrintTo(const RealArm& arm, std::ostream* out) { *out << arm.job; }

class RealArmTest : public ::testing::TestWithParam<RealArm> {};

TEST_P(RealArmTest, IsAsAccurateOnHeldOutPosesAsAPlainFitOrBetter) {
  if (!std::filesystem::exists(DataDirectory())) {
    GTEST_SKIP() << "no measured data in " << DataDirectory()
                 << "; ALIDADE_DATA names their folder";
  }
  ASSERT_EQ(setenv("ALIDADE_DATA", DataDirectory().c_str(), 1), 0);
  const JobConfig job =
      LoadJob(std::string(ALIDADE_SOURCE_DIR) + "/configs/real_arms/" +
              GetParam().job + ".yaml");
  const JobOutcome outcome = RunJob(job, "test", 2);
  ASSERT_EQ(outcome.status, JobStatus::kDone) << outcome.message;
  const JobResult& result = outcome.result;
  EXPECT_EQ(result.identifiability.structural_rank.rank, GetParam().rank);
  EXPECT_EQ(result.identifiability.num_free, GetParam().rank);
  EXPECT_NEAR(result.heldout->after.mean * 1e3, GetParam().plain,
              GetParam().tolerance);
  EXPECT_LT(result.heldout->after.mean, result.heldout->before.mean);
  ASSERT_EQ(result.stages.size(), 3u);
}

INSTANTIATE_TEST_SUITE_P(
    Sets, RealArmTest,
    ::testing::Values(RealArm{"panda_left", 31, 0.39, 0.12},
                      RealArm{"panda_right", 31, 0.41, 0.12},
                      RealArm{"panda_top", 31, 0.37, 0.12},
                      RealArm{"rokae_position", 27, 0.139, 0.05},
                      RealArm{"lifting_column", 29, 3.0, 0.4}),
    [](const ::testing::TestParamInfo<RealArm>& arm) { return arm.param.job; });

}  // namespace
}  // namespace alidade
