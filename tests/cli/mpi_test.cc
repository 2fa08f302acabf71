// The program as several processes under mpirun: the same bytes as alone, and
// one message where something is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace alidade {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;

namespace fs = std::filesystem;

// Open MPI keeps memory to the end, and asks before it runs as root; machines
// without the right to read another process' memory warn of it.
std::string Mpirun(int processes) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
         "ASAN_OPTIONS=detect_leaks=0 " +
         std::string(ALIDADE_MPIEXEC) + " --oversubscribe --quiet " +
         "--mca btl_vader_single_copy_mechanism none -n " +
         std::to_string(processes) + " ";
}

int Count(const std::string& text, const std::string& what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + 1)) {
    ++count;
  }
  return count;
}

class MpiTest : public ::testing::Test {
 protected:
  // The 3600 poses of the study in three files of different length.
  void SetUp() override {
    std::ifstream all(std::string(ALIDADE_SOURCE_DIR) +
                      "/datasets/rv2aj/flange_3600.csv");
    std::string header;
    while (std::getline(all, header) && header.front() == '#') continue;
    for (const int rows : {1000, 200, 2400}) {
      shards_.push_back(scratch_ /
                        ("shard" + std::to_string(shards_.size()) + ".csv"));
      std::string text = header + "\n";
      std::string line;
      for (int row = 0; row < rows && std::getline(all, line); ++row) {
        text += line + "\n";
      }
      testing::WriteWhole(shards_.back(), text);
    }
    const std::string robots =
        std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/";
    testing::WriteWhole(
        scratch_ / "job.yaml",
        "format: alidade-job-1\ntitle: shards\nunits: {length: mm, angle: "
        "rad}\narm: " +
            robots +
            "rv2aj_flange.yaml\ndata: ['shard*.csv']\n"
            "measurement: {sigma: 0.02}\n");
  }

  // In a directory of its own, to which the result goes.
  ProcessResult Calibrate(const std::string& launcher,
                          const std::string& directory) const {
    fs::create_directories(scratch_ / directory);
    return testing::RunProcess("cd " + (scratch_ / directory) + " && " +
                               launcher + ALIDADE_BINARY + " calibrate " +
                               (scratch_ / "job.yaml") + " --out=result");
  }

  std::string ResultFile(const std::string& directory,
                         const std::string& name) const {
    static const std::regex times(
        "\"([a-z_]*time_s|identify_s|total_s)\": [^,\n}]*");
    return std::regex_replace(
        testing::ReadWhole(scratch_ / (directory + "/result/" + name)), times,
        "$1");
  }

  const testing::TemporaryDirectory scratch_;
  std::vector<std::string> shards_;
};

TEST_F(MpiTest, TwoProcessesWriteTheBytesOfOne) {
  const ProcessResult alone = Calibrate("", "alone");
  ASSERT_EQ(alone.status, 0) << alone.err;
  const ProcessResult both = Calibrate(Mpirun(2), "both");
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.out, alone.out);
  EXPECT_EQ(both.err, alone.err);
  for (const char* name : {"result.json", "arm.yaml", "residuals.csv"}) {
    EXPECT_FALSE(ResultFile("alone", name).empty()) << name;
    EXPECT_EQ(ResultFile("both", name), ResultFile("alone", name)) << name;
  }
}

TEST_F(MpiTest, AShardThatCannotBeReadEndsAllWithOneMessage) {
  std::ofstream(shards_[2], std::ios::app) << "1,2,3,4,5,here,7,8\n";
  const ProcessResult result = Calibrate(Mpirun(3), "broken");
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(Count(result.err, "alidade: "), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("shard2.csv:2402"));
  EXPECT_EQ(result.out, "");
  EXPECT_FALSE(fs::exists(scratch_ / "broken/result"));
}

TEST_F(MpiTest, AMissingFileEndsAllWithOneMessage) {
  const std::string job = testing::ReadWhole(scratch_ / "job.yaml");
  testing::WriteWhole(scratch_ / "job.yaml",
                      std::regex_replace(job, std::regex("'shard.*csv'"),
                                         "shard0.csv, shard1.csv, none.csv"));
  const ProcessResult result = Calibrate(Mpirun(2), "missing");
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(Count(result.err, "alidade: "), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("none.csv"));
  EXPECT_FALSE(fs::exists(scratch_ / "missing/result"));
}

TEST_F(MpiTest, OtherCommandsRunAlone) {
  const ProcessResult result = testing::RunProcess(
      Mpirun(2) + ALIDADE_BINARY + " show " + (scratch_ / "job.yaml"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(Count(result.err, "alidade: "), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("2 were started together"));
  EXPECT_THAT(result.out, Not(HasSubstr("shards")));
}

}  // namespace
}  // namespace alidade
