// The program as several processes under mpirun: the same bytes as alone, and
// one message where something is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "src/common/random.h"
#include "tests/support/batch_outcome.h"
#include "tests/support/process.h"

namespace alidade::internal::mpi_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;

namespace fs = std::filesystem;

// Open MPI keeps memory to the end, and asks before it runs as root. The
// processes speak over the loopback: shared memory is a file, which a limit of
// files' sizes limits too, and a machine may have no other network.
std::string Mpirun(int processes) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
         "ASAN_OPTIONS=detect_leaks=0 " +
         std::string(ALIDADE_MPIEXEC) + " --oversubscribe " +
         "--mca btl self,tcp --mca btl_tcp_if_include lo -n " +
         std::to_string(processes) + " ";
}

// What the program said: mpirun's own notices, which differ between versions,
// stand between lines of dashes.
std::string WithoutNotices(const std::string& text) {
  const std::string dashes(60, '-');
  std::string kept;
  std::istringstream lines(text);
  bool is_notice = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, dashes.size(), dashes) == 0) {
      is_notice = !is_notice;
    } else if (!is_notice) {
      kept += line + "\n";
    }
  }
  return kept;
}

ProcessResult WithoutNotices(ProcessResult result) {
  result.out = WithoutNotices(result.out);
  result.err = WithoutNotices(result.err);
  return result;
}

ProcessResult RunQuietly(const std::string& command) {
  return WithoutNotices(testing::RunProcess(command));
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
    return WithoutNotices(testing::RunIn(
        scratch_ / directory, launcher + ALIDADE_BINARY + " calibrate " +
                                  (scratch_ / "job.yaml") + " --out=result"));
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
  const ProcessResult result = RunQuietly(Mpirun(2) + ALIDADE_BINARY +
                                          " show " + (scratch_ / "job.yaml"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(Count(result.err, "alidade: "), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("2 were started together"));
  EXPECT_THAT(result.out, Not(HasSubstr("shards")));
}

const std::string kThousand =
    std::string(ALIDADE_SOURCE_DIR) + "/configs/batches/rv2aj_1000.yaml";

// Batches by processes of one thread each.
class MpiBatchTest : public ::testing::Test {
 protected:
  // So many of the repository's thousand.
  std::string WriteFew(int count) const {
    const std::string path = scratch_ / "few.yaml";
    testing::WriteWhole(path, "format: alidade-job-1\nextends: " + kThousand +
                                  "\nmatrix: {data.simulate.seed: {range: " +
                                  std::to_string(count) + "}}\n");
    return path;
  }

  // `launcher`: what comes before the program.
  ProcessResult Batch(const std::string& launcher, const std::string& words,
                      const std::string& out) const {
    return RunQuietly(launcher + ALIDADE_BINARY + " batch " + words +
                      " --out=" + (scratch_ / out));
  }

  std::map<std::string, std::string> Outcome(const std::string& out) const {
    return testing::BatchOutcome(scratch_ / out);
  }

  const testing::TemporaryDirectory scratch_;
};

TEST_F(MpiBatchTest, ProcessesWriteTheBytesOfThreads) {
  const std::string wrong = scratch_ / "wrong.yaml";
  testing::WriteWhole(wrong, "format: alidade-job-1\ntitel: x\n");
  const std::string jobs = WriteFew(12) + " " + wrong + " nowhere.yaml";
  const ProcessResult threads = Batch("", jobs + " --threads=2", "threads");
  EXPECT_EQ(threads.status, 2) << threads.err;
  EXPECT_EQ(Outcome("threads").size(), 2U * 12U + 3U);
  for (const int processes : {2, 3}) {
    const std::string out = "processes" + std::to_string(processes);
    const ProcessResult result = Batch(Mpirun(processes), jobs, out);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(std::regex_replace(result.out, std::regex(out), "threads"),
              threads.out);
    // Each job that is wrong is told once.
    EXPECT_EQ(Count(result.err, "alidade: "), 2) << result.err;
    EXPECT_THAT(result.err, HasSubstr("alidade: wrong: bad input: "));
    EXPECT_THAT(result.err, HasSubstr("alidade: nowhere: bad input: "));
    EXPECT_EQ(Outcome(out), Outcome("threads"));
  }
}

TEST_F(MpiBatchTest, DryRunIsPrintedOnce) {
  const std::string jobs = WriteFew(2) + " --dry-run";
  const ProcessResult alone = Batch("", jobs, "out");
  const ProcessResult both = Batch(Mpirun(2), jobs, "out");
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(both.out, alone.out);
  EXPECT_FALSE(fs::exists(scratch_ / "out"));
}

TEST_F(MpiBatchTest, WhatEndsTheBatchEndsAllWithOneMessage) {
  const std::string few = WriteFew(6);
  const ProcessResult unwritable = RunQuietly(
      Mpirun(2) + ALIDADE_BINARY + " batch " + few + " --out=/dev/null/x");
  EXPECT_EQ(unwritable.status, 2);
  EXPECT_EQ(Count(unwritable.err, "alidade: "), 1) << unwritable.err;
  EXPECT_THAT(unwritable.err, HasSubstr("directory cannot be made"));
  // Files of more than 4 kB cannot be written by any process.
  const ProcessResult full =
      RunQuietly("echo \"trap '' XFSZ; ulimit -f 8; exec \\\"\\$@\\\"\" >" +
                 (scratch_ / "full.sh") + "; " + Mpirun(3) + "bash " +
                 (scratch_ / "full.sh") + " " + ALIDADE_BINARY + " batch " +
                 few + " --out=" + (scratch_ / "full"));
  EXPECT_EQ(full.status, 2);
  EXPECT_EQ(Count(full.err, "alidade: "), 1) << full.err;
  EXPECT_THAT(full.err, HasSubstr("result.json: cannot be written: File"));
  EXPECT_FALSE(fs::exists(scratch_ / "full/few"));
  // Once there is room, the same command does the rest.
  EXPECT_EQ(Batch(Mpirun(2), few, "full").status, 0);
  EXPECT_TRUE(fs::exists(scratch_ / "full/few/seed-6/result.json"));
}

TEST_F(MpiBatchTest, FailFastEndsAll) {
  std::string jobs;
  for (int i = 0; i < 100; ++i) jobs += "no" + std::to_string(i) + ".yaml ";
  const ProcessResult result = Batch(Mpirun(3), jobs + "--fail-fast", "out");
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_THAT(result.out, HasSubstr(" not run"));
  EXPECT_LE(Count(result.err, "alidade: "), 20) << result.err;
}

// Processes of a killed mpirun may still be ending when the next one begins.
bool IsHeldByAnother(const ProcessResult& result) {
  return result.status == 2 &&
         result.err.find("another batch is writing") != std::string::npos;
}

TEST_F(MpiBatchTest, KilledAtAnyMomentItGoesOn) {
  const std::string few = WriteFew(12);
  ASSERT_EQ(Batch("", few + " --threads=2", "undisturbed").status, 0);
  Random random(7);
  int kills = 0;
  while (kills < 5) {
    const double seconds = random.Uniform(0.3, 1.0);
    const ProcessResult result =
        Batch("timeout --signal=KILL " + std::to_string(seconds) + " env " +
                  Mpirun(2),
              few, "out");
    if (IsHeldByAnother(result)) continue;
    if (result.status == 0) {
      EXPECT_EQ(Outcome("out"), Outcome("undisturbed"));
      fs::remove_all(scratch_ / "out");
    } else {
      EXPECT_EQ(result.status, 128 + SIGKILL) << result.err;
      ++kills;
    }
  }
  ProcessResult last;
  do {
    last = Batch(Mpirun(2), few, "out");
  } while (IsHeldByAnother(last));
  EXPECT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(Outcome("out"), Outcome("undisturbed"));
}

TEST_F(MpiBatchTest, AProcessThatDiesEndsTheRunAndTheNextGoesOn) {
  const std::string few = WriteFew(40);
  ASSERT_EQ(Batch("", few + " --threads=2", "undisturbed").status, 0);
  // The second of two kills itself in the middle of its work.
  testing::WriteWhole(scratch_ / "dies.sh",
                      "if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then\n"
                      "  (while [ ! -e \"" +
                          (scratch_ / "out/few") +
                          "\" ]; do :; done\n"
                          "   kill -9 $$) &\nfi\nexec \"$@\"\n");
  const ProcessResult died =
      Batch(Mpirun(2) + "bash " + (scratch_ / "dies.sh") + " ", few, "out");
  EXPECT_NE(died.status, 0);
  EXPECT_FALSE(fs::exists(scratch_ / "out/summary.json"));
  EXPECT_EQ(Batch(Mpirun(2), few, "out").status, 0);
  EXPECT_EQ(Outcome("out"), Outcome("undisturbed"));
}

// Without mpirun: an environment that another launcher has left.
TEST(LaunchTest, ARankWithoutASizeIsRefused) {
  for (const std::string environment :
       {"PMIX_RANK=1", "PMI_RANK=0", "PMIX_RANK=2 PMI_SIZE=2"}) {
    const ProcessResult result = RunQuietly(environment + " " + ALIDADE_BINARY +
                                            " calibrate nothing.yaml");
    EXPECT_EQ(result.status, 2) << environment;
    EXPECT_THAT(result.err, HasSubstr("but not of how many")) << environment;
  }
  const ProcessResult result = RunQuietly(
      "PMIX_RANK=one " + std::string(ALIDADE_BINARY) + " plan nothing.yaml");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("PMIX_RANK = \"one\" is no number"));
}

}  // namespace
}  // namespace alidade::internal::mpi_test
