// Results that must not be used: exit status 3, and what is written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::rejected_test {
namespace {

using ::testing::HasSubstr;
using testing::ProcessResult;
using testing::TemporaryDirectory;
using testing::WriteWhole;

// Stopped after one step, far from the minimum.
constexpr char kJob[] =
    "format: alidade-job-1\ntitle: Arm\nunits: {length: mm, angle: deg}\n"
    "arm: " ALIDADE_SOURCE_DIR
    "/configs/robots/rv2aj_wrist.yaml\n"
    "data: " ALIDADE_SOURCE_DIR
    "/datasets/rv2aj/wrist_56.csv\n"
    "measurement: {sigma: 0.0001}\nsolver: {max_iterations: 1}\n";

ProcessResult CalibrateIn(const TemporaryDirectory& directory,
                          const std::string& flags) {
  WriteWhole(directory / "job.yaml", kJob);
  return testing::RunIn(
      directory.path(),
      std::string(ALIDADE_BINARY) + " calibrate job.yaml --out=r " + flags);
}

bool Exists(const TemporaryDirectory& directory, const std::string& name) {
  return std::filesystem::exists(directory.path() / "r" / name);
}

TEST(RejectedResultTest, IsNotWritten) {
  const TemporaryDirectory directory;
  const ProcessResult result = CalibrateIn(directory, "");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("stopped by the number of iterations"));
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "r"));
}

TEST(RejectedResultTest, IsKeptUnderAnotherNameWhereAskedFor) {
  const TemporaryDirectory directory;
  const ProcessResult result =
      CalibrateIn(directory, "--keep-rejected --report");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("stopped by the number of iterations"));
  EXPECT_FALSE(Exists(directory, "arm.yaml"));
  EXPECT_TRUE(Exists(directory, "arm.rejected.yaml"));
  const std::string json = testing::ReadWhole(directory / "r/result.json");
  EXPECT_THAT(json, HasSubstr("\"decision\": \"rejected\""));
  const std::string text = testing::ReadWhole(directory / "r/report.txt");
  EXPECT_THAT(text, HasSubstr("Rejected. "));
  EXPECT_THAT(text, HasSubstr("Reason: The solver was stopped"));
  EXPECT_TRUE(Exists(directory, "report.html"));
  // A second run replaces it.
  EXPECT_EQ(CalibrateIn(directory, "--keep-rejected").status, 3);
}

// Nobody takes the result of an earlier run for that of this one.
TEST(RejectedResultTest, AnEarlierResultIsRemoved) {
  const TemporaryDirectory directory;
  std::string job = kJob;
  job.erase(job.find("solver:"));
  WriteWhole(directory / "good.yaml", job);
  ASSERT_EQ(testing::RunIn(directory.path(), std::string(ALIDADE_BINARY) +
                                                 " calibrate good.yaml --out=r")
                .status,
            0);
  WriteWhole(directory / "r/notes.txt", "mine");
  EXPECT_EQ(CalibrateIn(directory, "").status, 3);
  EXPECT_FALSE(Exists(directory, "arm.yaml"));
  EXPECT_FALSE(Exists(directory, "result.json"));
  EXPECT_TRUE(Exists(directory, "notes.txt"));
}

TEST(RejectedResultTest, TheFlagDoesNothingToOthers) {
  const TemporaryDirectory directory;
  std::string job = kJob;
  job.erase(job.find("solver:"));
  WriteWhole(directory / "good.yaml", job);
  const ProcessResult result = testing::RunIn(
      directory.path(), std::string(ALIDADE_BINARY) +
                            " calibrate good.yaml --out=r --keep-rejected");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(Exists(directory, "arm.yaml"));
  EXPECT_FALSE(Exists(directory, "arm.rejected.yaml"));
}

}  // namespace
}  // namespace alidade::internal::rejected_test
