#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/error.h"
#include "src/fleet/remote_jobs.h"
#include "src/fleet/result_store.h"
#include "tests/fleet/batch_test_util.h"
#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ReadWhole;
using ::testing::StartsWith;
using testing::WithoutTimes;
using testing::WriteWhole;

// Runs of several threads as ranks, which have a directory each.
class ParallelBatchTest : public BatchTest {
 protected:
  ParallelBatchTest() { options_.on_finished = nullptr; }

  BatchSummary RunAs(int size, const std::vector<std::string>& files,
                     const std::string& directory) {
    std::vector<std::string> paths;
    for (const std::string& file : files) paths.push_back(Path(file));
    options_.directory = Path(directory);
    BatchSummary of_root;
    RunOnThreads(size, [&](Communicator* communicator) {
      BatchSummary summary = RunBatch(PlanBatch(paths), options_, communicator);
      if (communicator->is_root()) {
        of_root = std::move(summary);
      } else {
        EXPECT_THAT(summary.entries, IsEmpty());
      }
    });
    return of_root;
  }
};

TEST_F(ParallelBatchTest, RanksWriteTheBytesOfOneProcess) {
  WriteWhole(Path("many.yaml"),
             kJob + "matrix: {data.simulate.seed: {range: 12}}\n");
  WriteWhole(Path("wrong.yaml"), "format: alidade-job-1\ntitel: x\n");
  WriteWhole(Path("refused.yaml"),
             kJob + "matrix: {data.simulate.poses.random.count: [4]}\n");
  const std::vector<std::string> files = {"wrong.yaml", "many.yaml",
                                          "refused.yaml"};
  RunAs(1, files, "alone");
  for (const int size : {2, 4}) {
    const std::string out = "ranks" + std::to_string(size);
    const BatchSummary summary = RunAs(size, files, out);
    EXPECT_EQ(summary.Count(BatchStatus::kDone), 12);
    EXPECT_EQ(summary.Worst(), BatchStatus::kFailed);
    for (const char* name : {"/summary.json", "/summary.csv"}) {
      EXPECT_EQ(ReadWhole(Path(out + name)), ReadWhole(Path("alone") + name));
    }
    for (const BatchEntry& entry : summary.entries) {
      if (entry.directory.empty()) {
        EXPECT_FALSE(fs::exists(Path(out + "/" + entry.name)));
        continue;
      }
      const std::string result = "/" + entry.directory + "/result.json";
      EXPECT_EQ(WithoutTimes(Path(out + result)),
                WithoutTimes(Path("alone" + result)));
      const std::string arm = "/" + entry.directory + "/arm.yaml";
      EXPECT_EQ(ReadWhole(Path(out + arm)), ReadWhole(Path("alone" + arm)));
    }
    // Nothing is left of what ranks wrote; nothing is to be done again.
    for (const auto& entry : fs::directory_iterator(Path(out + "/.batch"))) {
      EXPECT_THAT(entry.path().filename().string(), Not(StartsWith("staged")));
    }
    EXPECT_THAT(FindDone(PlanBatch({Path("many.yaml")}), options_),
                ::testing::Each(true));
  }
}

TEST_F(ParallelBatchTest, ASecondRunDoesNothing) {
  RunAs(2, {"fleet.yaml"}, "out");
  const std::string result = ReadWhole(Path("out/fleet/seed-1/result.json"));
  std::int64_t num_found = 0;
  options_.on_finished = [&num_found](const BatchProgress& progress) {
    num_found = progress.num_found;
  };
  RunAs(3, {"fleet.yaml"}, "out");
  EXPECT_EQ(num_found, 3);
  EXPECT_EQ(ReadWhole(Path("out/fleet/seed-1/result.json")), result);
}

TEST_F(ParallelBatchTest, FailFastStopsAllRanks) {
  std::vector<std::string> files;
  for (int i = 0; i < 200; ++i) {
    files.push_back("missing" + std::to_string(i) + ".yaml");
  }
  options_.fail_fast = true;
  const BatchSummary summary = RunAs(3, files, "out");
  // Each rank may have had one under way when the first failed, and taken
  // another before that was known.
  EXPECT_GE(summary.Count(BatchStatus::kBadInput), 1);
  EXPECT_LE(summary.Count(BatchStatus::kBadInput), 20);
  EXPECT_GE(summary.Count(BatchStatus::kNotRun), 180);
}

TEST_F(ParallelBatchTest, ADirectoryThatCannotBeWrittenEndsAllRanks) {
  WriteWhole(Path("file"), "");
  EXPECT_THROW(RunAs(3, {"fleet.yaml"}, "file/out"), InputError);
  // A result's parent that is a file: seen when the first result is placed.
  WriteWhole(Path("out/fleet"), "");
  EXPECT_THROW(RunAs(3, {"fleet.yaml"}, "out"), InputError);
}

// Ranks of which all but the first compute, so that no one else can have.
TEST_F(ParallelBatchTest, OtherRanksDoAllThatTheRootHandsOut) {
  const BatchPlan plan = PlanBatch({Path("fleet.yaml")});
  fs::create_directories(Path("out/.batch"));
  options_.directory = Path("out");
  std::int64_t next = 0;
  std::vector<std::string> done;
  RunOnThreads(3, [&](Communicator* communicator) {
    WorkTimes times;
    if (!communicator->is_root()) {
      const JobComputer computer(plan, options_, 1, &times);
      StagingArea staging(Path("out"), std::to_string(communicator->rank()));
      WorkForRoot(communicator, plan, computer, 2, &staging, &times);
      return;
    }
    JobDispatcher dispatcher;
    dispatcher.take = [&]() -> std::optional<std::int64_t> {
      if (next == 3) return std::nullopt;
      return next++;
    };
    dispatcher.finish = [&](const RemoteOutcome& outcome) {
      EXPECT_EQ(outcome.record.entry.name, plan.jobs[outcome.number].name);
      EXPECT_TRUE(fs::exists(outcome.staged + "/result.json"));
      done.push_back(outcome.record.entry.name);
    };
    dispatcher.fail = [](const std::string& error) { ADD_FAILURE() << error; };
    dispatcher.add_times = [&times](const WorkTimes& more) { times.Add(more); };
    ServeJobs(communicator, dispatcher);
    DismissRanks(communicator);
    EXPECT_GT(times.calibrating, 0);
  });
  std::sort(done.begin(), done.end());
  EXPECT_THAT(done,
              ElementsAre("fleet/seed-1", "fleet/seed-2", "fleet/seed-3"));
}

// As on a full disk.
TEST_F(ParallelBatchTest, WhatARankCannotWriteIsToldToTheRoot) {
  const BatchPlan plan = PlanBatch({Path("fleet.yaml")});
  options_.directory = Path("out");
  WriteWhole(Path("out/.batch"), "a file where a folder should be");
  std::int64_t next = 0;
  std::vector<std::string> errors;
  RunOnThreads(2, [&](Communicator* communicator) {
    WorkTimes times;
    if (!communicator->is_root()) {
      const JobComputer computer(plan, options_, 1, &times);
      StagingArea staging(Path("out"), "1");
      WorkForRoot(communicator, plan, computer, 1, &staging, &times);
      return;
    }
    JobDispatcher dispatcher;
    dispatcher.take = [&]() -> std::optional<std::int64_t> {
      if (next == 3 || !errors.empty()) return std::nullopt;
      return next++;
    };
    dispatcher.finish = [](const RemoteOutcome&) { ADD_FAILURE(); };
    dispatcher.fail = [&](const std::string& error) {
      try {
        ThrowDescribed(error);
      } catch (const InputError& input) {
        errors.emplace_back(input.what());
      }
    };
    dispatcher.add_times = [](const WorkTimes&) {};
    ServeJobs(communicator, dispatcher);
    DismissRanks(communicator);
  });
  ASSERT_FALSE(errors.empty());
  EXPECT_THAT(errors.front(), StartsWith(Path("out/.batch")));
}

}  // namespace
}  // namespace alidade::internal
