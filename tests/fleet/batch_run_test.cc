#include "alidade/batch_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "alidade/error.h"
#include "tests/fleet/batch_test_util.h"

namespace alidade::internal {
namespace {

using nlohmann::json;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

class RunBatchOfFilesTest : public BatchTest {
 protected:
  RunBatchOfFilesTest() {
    batch_.directory = Path("out");
    batch_.on_finished = [this](std::int64_t finished, std::int64_t jobs,
                                const std::string& name) {
      finished_.push_back(finished);
      jobs_.push_back(jobs);
      names_.push_back(name);
    };
  }

  json RunFiles(const std::vector<std::string>& files) {
    finished_.clear();
    jobs_.clear();
    names_.clear();
    std::vector<std::string> paths;
    for (const std::string& file : files) paths.push_back(Path(file));
    return json::parse(RunBatchOfFiles(paths, batch_));
  }

  static std::vector<std::string> Of(const json& summary,
                                     const std::string& key) {
    std::vector<std::string> values;
    for (const json& job : summary["jobs"]) values.push_back(job[key]);
    return values;
  }

  BatchRunOptions batch_;
  std::vector<std::int64_t> finished_, jobs_;
  std::vector<std::string> names_;
};

TEST_F(RunBatchOfFilesTest, RunsEveryJobAndSaysHowFarItIs) {
  for (const int threads : {1, 3}) {
    batch_.num_threads = threads;
    batch_.directory = Path("out" + std::to_string(threads));
    const json summary = RunFiles({"fleet.yaml"});
    EXPECT_THAT(Of(summary, "status"), ElementsAre("done", "done", "done"));
    EXPECT_THAT(finished_, ElementsAre(1, 2, 3));
    EXPECT_THAT(jobs_, Each(3));
    EXPECT_THAT(names_, UnorderedElementsAre("fleet/seed-1", "fleet/seed-2",
                                             "fleet/seed-3"));
    EXPECT_EQ(
        json::parse(testing::ReadWhole(batch_.directory + "/summary.json")),
        summary);
    EXPECT_TRUE(std::filesystem::exists(batch_.directory + "/comparison.html"));
  }
}

TEST_F(RunBatchOfFilesTest, WhatIsDoneIsNotDoneAgain) {
  const json first = RunFiles({"fleet.yaml"});
  const auto file = Path("out/fleet/seed-2/result.json");
  const auto time = std::filesystem::last_write_time(file);
  batch_.on_finished = nullptr;
  const json second = RunFiles({"fleet.yaml"});
  EXPECT_EQ(std::filesystem::last_write_time(file), time);
  EXPECT_EQ(Of(second, "status"), Of(first, "status"));
}

TEST_F(RunBatchOfFilesTest, WhatGoesWrongIsInItsEntry) {
  testing::WriteWhole(Path("bad.yaml"), "format: alidade-job-1\ntitle: 3\n");
  testing::WriteWhole(Path("empty.yaml"), "");
  const json summary =
      RunFiles({"bad.yaml", "no.yaml", "empty.yaml", "fleet.yaml"});
  std::vector<std::string> done;
  int wrong = 0;
  for (const json& job : summary["jobs"]) {
    if (job["status"] == "done") {
      done.push_back(job["name"]);
      continue;
    }
    ++wrong;
    EXPECT_NE(job["message"], "");
  }
  EXPECT_EQ(done.size(), 3U);
  EXPECT_EQ(wrong, 3);
}

TEST_F(RunBatchOfFilesTest, FailFastHandsOutNoMore) {
  testing::WriteWhole(Path("bad.yaml"), "format: alidade-job-1\n");
  batch_.fail_fast = true;
  const json summary = RunFiles({"bad.yaml", "fleet.yaml"});
  EXPECT_THAT(Of(summary, "status"), Each(::testing::Ne(std::string("done"))));
}

TEST_F(RunBatchOfFilesTest, RefusesNoJobsAndADirectoryThatCannotBe) {
  EXPECT_THROW(RunBatchOfFiles({}, batch_), InputError);
  std::filesystem::create_directory(Path("nothing"));
  EXPECT_THROW(RunFiles({"nothing"}), InputError);
  // A file is in the way.
  batch_.directory = Path("arm.yaml");
  EXPECT_THROW(RunFiles({"fleet.yaml"}), InputError);
  batch_.directory = "";
  EXPECT_THROW(RunFiles({"fleet.yaml"}), InputError);
}

}  // namespace
}  // namespace alidade::internal
