// Data that do not fit into the memory that the program may take: the same
// files, from arrays that lie in temporary ones. (Arrays that stay in the file
// of the data are larger than a test should be: tests/batch/in_place_test.cc.)

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal::large_data_test {
namespace {

using ::testing::HasSubstr;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WithoutTimes;
using testing::WriteWhole;

class LargeDataTest : public ::testing::Test {
 protected:
  // Enough poses for each of their arrays to be counted as a large one.
  void SetUp() override {
    WriteWhole(directory_ / "simulation.yaml",
               "format: alidade-simulation-1\ntitle: many\n"
               "units: {length: mm, angle: deg}\narm: " +
                   kRobots + "/rv2aj_flange.yaml\ndeviations: " + kRobots +
                   "/rv2aj_deviations.yaml\n"
                   "poses: {random: {count: 50000}}\nnoise: {sigma: 0.02}\n"
                   "seed: 1\njoint_decimals: 4\noutput: poses.csv\n");
    ASSERT_EQ(Alidade("simulate simulation.yaml --out=poses.csv").status, 0);
  }

  void WriteJob(const std::string& name, const std::string& data) {
    WriteWhole(directory_ / name,
               "format: alidade-job-1\ntitle: many\n"
               "units: {length: mm, angle: deg}\narm: " +
                   kRobots + "/rv2aj_flange.yaml\ndata: " + data +
                   "\nmeasurement: {sigma: 0.02}\n"
                   "validation: {fraction: 0.2}\n");
  }

  // `before` stands before the program in the shell's line.
  ProcessResult Alidade(const std::string& arguments,
                        const std::string& before = "") {
    return testing::RunIn(directory_.path(),
                          before + " " + ALIDADE_BINARY + " " + arguments);
  }

  void ExpectSameResults(const std::string& a, const std::string& b) {
    for (const char* name : {"arm.yaml", "residuals.csv", "validation.csv",
                             "influence.csv", "error_after.svg"}) {
      // What differs would be too much to print.
      EXPECT_TRUE(ReadWhole(directory_ / (a + "/" + name)) ==
                  ReadWhole(directory_ / (b + "/" + name)))
          << name;
    }
  }

  const std::string kRobots = ALIDADE_SOURCE_DIR "/configs/robots";
  const TemporaryDirectory directory_;
};

TEST_F(LargeDataTest, WithNextToNoMemoryTheResultIsTheSame) {
  WriteJob("job.yaml", "poses.csv");
  ASSERT_EQ(Alidade("calibrate job.yaml --out=free").status, 0);
  // In MB: every array lies in a temporary file, in a directory of our choice.
  WriteWhole(directory_ / "temporary/none", "");
  const ProcessResult result =
      Alidade("calibrate job.yaml --memory=1 --threads=2 --out=tight",
              "TMPDIR=temporary");
  ASSERT_EQ(result.status, 0) << result.err;
  ExpectSameResults("free", "tight");
  EXPECT_TRUE(WithoutTimes(directory_ / "free/result.json") ==
              WithoutTimes(directory_ / "tight/result.json"));
}

TEST_F(LargeDataTest, WithoutRoomForTemporaryFilesNothingIsWritten) {
  WriteJob("job.yaml", "poses.csv");
  const ProcessResult result =
      Alidade("calibrate job.yaml --memory=1 --out=result",
              "TMPDIR=/nonexistent/place");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("/nonexistent/place: no temporary file"));
  EXPECT_THAT(result.err, HasSubstr("TMPDIR"));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "result"));
}

TEST_F(LargeDataTest, MemoryIsANumberOfMegabytes) {
  for (const char* value : {"1GB", "-1", "half", "99999999999"}) {
    const ProcessResult result =
        Alidade(std::string("show poses.csv --memory=") + value);
    EXPECT_EQ(result.status, 2) << value;
    EXPECT_THAT(result.err, HasSubstr("--memory = ")) << value;
  }
}

}  // namespace
}  // namespace alidade::internal::large_data_test
