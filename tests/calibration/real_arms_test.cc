// Real measurements that are no part of the project: ALIDADE_DATA names their
// folder. Skipped, with a message, where it is not set or a job's own file is
// not there.

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "src/job/run_job.h"
#include "src/serialization/job_config.h"
#include "tests/support/real_arm_data.h"

namespace alidade::internal::real_arms_test {
namespace {

std::string PathOf(const std::string& job) {
  return std::string(ALIDADE_SOURCE_DIR) + "/configs/real_arms/" + job +
         ".yaml";
}

// Mean error on validation poses (mm) that one split leaves. A plain
// least-squares fit by another program (scipy, weak priors; docs/real_arms.md)
// reached `plain` as a mean over ten splits; single splits of small sets differ
// by some 20 % of it.
struct RealArm {
  std::string job;
  int rank;
  double plain;
  double tolerance;
};

void PrintTo(const RealArm& arm, std::ostream* out) { *out << arm.job; }

class RealArmTest : public ::testing::TestWithParam<RealArm> {};

TEST_P(RealArmTest, IsAsAccurateOnHeldOutPosesAsAPlainFitOrBetter) {
  const std::string path = PathOf(GetParam().job);
  if (const std::string lack = testing::WhatDataLack(path); !lack.empty()) {
    GTEST_SKIP() << lack;
  }
  const CalibrationResult outcome = RunJob(LoadJob(path), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  const CalibrationResult& result = outcome;
  EXPECT_EQ(result.identifiability.structural_rank.rank, GetParam().rank);
  EXPECT_EQ(result.identifiability.num_free, GetParam().rank);
  EXPECT_NEAR(result.validation->after.mean * 1e3, GetParam().plain,
              GetParam().tolerance);
  EXPECT_LT(result.validation->after.mean, result.validation->before.mean);
  ASSERT_EQ(result.stages.size(), 3u);
}

INSTANTIATE_TEST_SUITE_P(
    Sets, RealArmTest,
    ::testing::Values(RealArm{"panda_left", 31, 0.44, 0.12},
                      RealArm{"panda_right", 31, 0.435, 0.12},
                      RealArm{"panda_top", 31, 0.40, 0.12},
                      RealArm{"rokae", 30, 0.12, 0.04},
                      RealArm{"rokae_position", 27, 0.116, 0.04},
                      RealArm{"ur10_B", 30, 0.398, 0.04},
                      RealArm{"column", 29, 3.0, 0.4}),
    [](const ::testing::TestParamInfo<RealArm>& arm) { return arm.param.job; });

TEST(RealArmsTest, ThreeReflectorsTellThirtyThreeParametersApart) {
  const std::string path = PathOf("irb120");
  if (const std::string lack = testing::WhatDataLack(path); !lack.empty()) {
    GTEST_SKIP() << lack;
  }
  JobConfig job = LoadJob(path);
  // Ranks do not depend on the loss, the time does.
  job.options.loss = LossKind::kNone;
  const IdentifiabilityResult pass = AnalyzeTask(job);
  EXPECT_EQ(pass.structural_rank.rank, 33);
  EXPECT_EQ(pass.num_free, 33);
}

TEST(RealArmsTest, ABallInSocketsCalibratesAnArmWithoutAnInstrument) {
  const std::string path = PathOf("socket_panda_6");
  if (const std::string lack = testing::WhatDataLack(path); !lack.empty()) {
    GTEST_SKIP() << lack;
  }
  const CalibrationResult outcome = RunJob(LoadJob(path), "test");
  ASSERT_EQ(outcome.status, CalibrationStatus::kDone) << outcome.message;
  // The plain fit leaves 0.199 mm over ten splits.
  EXPECT_NEAR(outcome.validation->after.mean, 0.2e-3, 0.04e-3);
  EXPECT_GT(outcome.validation->before.mean, 5e-3);
  // Sockets of a plate are 50 mm apart, which keeps the arm from shrinking.
  const std::vector<ReferenceResult>& points = outcome.references;
  ASSERT_EQ(points.size(), 6u);
  for (const ReferenceResult& a : points) {
    for (const ReferenceResult& b : points) {
      const std::size_t slash = a.name.rfind('/');
      if (a.name >= b.name ||
          a.name.substr(0, slash) != b.name.substr(0, slash)) {
        continue;
      }
      EXPECT_NEAR((a.vector - b.vector).norm(), 0.05, 1e-4);
    }
  }
}

}  // namespace
}  // namespace alidade::internal::real_arms_test
