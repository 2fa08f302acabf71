#include "src/fleet/batch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_list.h"
#include "src/serialization/result_json.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"
#include "tests/fleet/batch_test_util.h"
#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ReadWhole;
using ::testing::StartsWith;
using testing::WithoutTimes;
using testing::WriteWhole;

TEST_F(BatchTest, WritesAResultForEveryJobAndASummary) {
  const BatchSummary summary = Run({"fleet.yaml"});
  ASSERT_EQ(summary.entries.size(), 3U);
  EXPECT_EQ(summary.Worst(), BatchStatus::kDone);
  for (const BatchEntry& entry : summary.entries) {
    EXPECT_EQ(entry.directory, entry.name);
    EXPECT_EQ(entry.num_free, 17);
    // 36 equations, 17 parameters, noise of 0.02 mm in each of 3 axes: about
    // 0.02 * sqrt(3 * 19 / 36) = 0.025 mm; the arm was 2 to 8 mm off.
    EXPECT_NEAR(entry.train_after.rms, 2.5e-5, 1.5e-5) << entry.name;
    EXPECT_NEAR(entry.train_before.rms, 5e-3, 3e-3) << entry.name;
    EXPECT_NO_THROW(LoadArm(Path("out/" + entry.directory + "/arm.yaml")));
  }
  EXPECT_NE(summary.entries[0].train_after.rms,
            summary.entries[1].train_after.rms);
  EXPECT_EQ(ReadWhole(Path("out/summary.csv")), FormatBatchCsv(summary));
  EXPECT_THAT(ReadWhole(Path("out/summary.csv")),
              HasSubstr("\nfleet/seed-2," + Path("fleet.yaml") + ","));
}

TEST_F(BatchTest, TheSummaryReadsBack) {
  const BatchSummary summary = Run({"fleet.yaml", "missing.yaml"});
  const BatchSummary read = LoadBatchSummary(Path("out/summary.json"));
  EXPECT_EQ(FormatBatchSummary(read), FormatBatchSummary(summary));
  EXPECT_EQ(FormatBatchCsv(read), FormatBatchCsv(summary));
  ASSERT_EQ(read.entries.size(), 4U);
  EXPECT_EQ(read.entries[2].train_after.rms,
            summary.entries[2].train_after.rms);
  EXPECT_EQ(read.entries[3].status, BatchStatus::kBadInput);
  EXPECT_EQ(read.entries[3].directory, "");
}

TEST_F(BatchTest, AFailingJobIsToldAndTheRestGoOn) {
  WriteWhole(Path("wrong.yaml"), "format: alidade-job-1\ntitel: x\n");
  WriteWhole(Path("refused.yaml"),
             kJob + "matrix: {data.simulate.poses.random.count: [4]}\n");
  const BatchSummary summary =
      Run({"wrong.yaml", "missing.yaml", "refused.yaml", "fleet.yaml"});
  ASSERT_EQ(summary.entries.size(), 6U);
  EXPECT_EQ(summary.entries[0].status, BatchStatus::kBadInput);
  EXPECT_THAT(summary.entries[0].message,
              StartsWith(Path("wrong.yaml") + ":2:1: titel: unknown key"));
  EXPECT_THAT(summary.entries[1].message, HasSubstr("cannot be read"));
  EXPECT_EQ(summary.entries[2].status, BatchStatus::kFailed);
  EXPECT_THAT(summary.entries[2].message, HasSubstr("rank"));
  EXPECT_EQ(summary.Count(BatchStatus::kDone), 3);
  EXPECT_EQ(summary.Worst(), BatchStatus::kFailed);
  EXPECT_FALSE(fs::exists(Path("out/refused")));
}

TEST_F(BatchTest, FailFastStartsNoMoreJobs) {
  options_.fail_fast = true;
  const BatchSummary summary = Run({"missing.yaml", "fleet.yaml"});
  EXPECT_EQ(summary.entries[0].status, BatchStatus::kBadInput);
  EXPECT_EQ(summary.Count(BatchStatus::kNotRun), 3);
  EXPECT_EQ(summary.Worst(), BatchStatus::kBadInput);
  EXPECT_FALSE(fs::exists(Path("out/fleet")));
}

TEST_F(BatchTest, ASecondRunDoesNothingAndTellsTheSame) {
  Run({"fleet.yaml"});
  EXPECT_EQ(ran_.size(), 3U);
  const std::string summary = ReadWhole(Path("out/summary.json"));
  const std::string result = ReadWhole(Path("out/fleet/seed-1/result.json"));
  fs::remove(Path("out/summary.json"));
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, IsEmpty());
  EXPECT_EQ(ReadWhole(Path("out/summary.json")), summary);
  EXPECT_EQ(ReadWhole(Path("out/fleet/seed-1/result.json")), result);
}

TEST_F(BatchTest, ThePageOfResultsSaysTheSameOnceTheyAreRead) {
  // Priors, sigmas that are estimated, validation poses, a limit that is
  // missed, and one without a result.
  WriteWhole(Path("other.yaml"),
             "format: alidade-job-1\nextends: fleet.yaml\nmatrix: ~\n"
             "identifiability: {method: rank}\nvalidation: {fraction: 0.3}\n"
             "data: {simulate: {poses: {random: {count: 40}}}}\n"
             "measurement: {sigma: estimate}\n"
             "acceptance: {train_rms: 1e-9}\n");
  WriteWhole(Path("wrong.yaml"), "format: alidade-job-1\ntitel: x\n");
  const std::vector<std::string> files = {"fleet.yaml", "other.yaml",
                                          "wrong.yaml"};
  const BatchSummary summary = Run(files);
  EXPECT_EQ(summary.Count(BatchStatus::kDone), 3);
  EXPECT_EQ(summary.Count(BatchStatus::kMissedLimits), 1)
      << summary.entries[3].message;
  const std::string page = ReadWhole(Path("out/comparison.html"));
  Run(files);
  EXPECT_THAT(ran_, ElementsAre("wrong"));
  EXPECT_TRUE(ReadWhole(Path("out/comparison.html")) == page);
}

TEST_F(BatchTest, RunsWhatIsMissing) {
  Run({"fleet.yaml"});
  fs::remove_all(Path("out/fleet/seed-2"));
  fs::remove(Path("out/fleet/seed-3/arm.yaml"));
  const BatchPlan plan = PlanBatch({Path("fleet.yaml")});
  EXPECT_THAT(FindDone(plan, options_), ElementsAre(true, false, false));
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, ElementsAre("fleet/seed-2", "fleet/seed-3"));
  EXPECT_THAT(FindDone(plan, options_), ElementsAre(true, true, true));
  // Other files than result.json, gone and cut short.
  fs::remove(Path("out/fleet/seed-1/arm.yaml"));
  fs::resize_file(Path("out/fleet/seed-3/arm.yaml"), 10);
  EXPECT_THAT(FindDone(plan, options_), ElementsAre(false, true, false));
}

// Tables of rows are made while they are written, after the job is done.
TEST_F(BatchTest, TablesOfRowsAreWhole) {
  options_.outputs = JobOutputs::kFull;
  Run({"fleet.yaml"});
  const std::string path = Path("out/fleet/seed-2/residuals.csv");
  const std::string table = ReadWhole(path);
  // A header and 12 poses.
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 13);
  EXPECT_THAT(table, StartsWith("pose,q1_deg,"));
  EXPECT_THAT(table, HasSubstr("\n12,"));
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, IsEmpty());
  fs::remove(path);
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, ElementsAre("fleet/seed-2"));
  EXPECT_EQ(ReadWhole(path), table);
}

// Whoever has changed it may want to keep it.
TEST_F(BatchTest, AResultThatWasChangedIsNotReplaced) {
  Run({"fleet.yaml"});
  WriteWhole(Path("out/fleet/seed-3/result.json"), "{}");
  const BatchPlan plan = PlanBatch({Path("fleet.yaml")});
  EXPECT_THAT(FindDone(plan, options_), ElementsAre(true, true, false));
  EXPECT_THROW(Run({"fleet.yaml"}), InputError);
  EXPECT_EQ(ReadWhole(Path("out/fleet/seed-3/result.json")), "{}");
}

TEST_F(BatchTest, RunsWhatIsChanged) {
  Run({"fleet.yaml"});
  // Another seed: the one job whose values are new.
  WriteWhole(Path("fleet.yaml"),
             kJob + "matrix: {data.simulate.seed: {range: [2, 4]}}\n");
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, ElementsAre("fleet/seed-4"));
  // An arm that says the same in other words is another input all the same.
  const std::string arm = ReadWhole(Path("arm.yaml"));
  WriteWhole(Path("arm.yaml"), arm + "# measured again\n");
  Run({"fleet.yaml"});
  EXPECT_EQ(ran_.size(), 3U);
  options_.outputs = JobOutputs::kFull;
  Run({"fleet.yaml"});
  EXPECT_EQ(ran_.size(), 3U);
  EXPECT_TRUE(fs::exists(Path("out/fleet/seed-2/report.txt")));
}

TEST_F(BatchTest, AnOldResultGoesWhenItsJobFails) {
  Run({"fleet.yaml"});
  ASSERT_TRUE(fs::exists(Path("out/fleet/seed-2")));
  fs::remove(Path("arm.yaml"));
  const BatchSummary summary = Run({"fleet.yaml"});
  EXPECT_EQ(summary.Count(BatchStatus::kBadInput), 3);
  EXPECT_FALSE(fs::exists(Path("out/fleet/seed-2")));
}

TEST_F(BatchTest, ThreadsDoNotMatter) {
  Run({"fleet.yaml"});
  const std::string one = WithoutTimes(Path("out/fleet/seed-1/result.json"));
  const std::string summary = ReadWhole(Path("out/summary.json"));
  options_.directory = Path("out4");
  options_.num_threads = 4;
  Run({"fleet.yaml"});
  EXPECT_EQ(ReadWhole(Path("out4/summary.json")), summary);
  EXPECT_EQ(WithoutTimes(Path("out4/fleet/seed-1/result.json")), one);
}

TEST_F(BatchTest, ATornLineOfTheJournalIsOneJobMore) {
  Run({"fleet.yaml"});
  const std::string path = Path("out/.batch/journal.jsonl");
  const std::string journal = ReadWhole(path);
  WriteWhole(path, journal.substr(0, journal.size() - 20));
  Run({"fleet.yaml"});
  EXPECT_EQ(ran_.size(), 1U);
  // The line after the torn one is whole.
  Run({"fleet.yaml"});
  EXPECT_THAT(ran_, IsEmpty());
}

TEST_F(BatchTest, StagedLeftoversAreCleared) {
  WriteWhole(Path("out/.batch/staged-7/result.json"), "{");
  Run({"fleet.yaml"});
  EXPECT_FALSE(fs::exists(Path("out/.batch/staged-7")));
}

TEST_F(BatchTest, WhatIsNoResultIsNotReplaced) {
  WriteWhole(Path("out/fleet/seed-2/thesis.tex"), "years of work");
  try {
    Run({"fleet.yaml"});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("out/fleet/seed-2"));
    EXPECT_THAT(error.what(), HasSubstr("choose another --out"));
  }
  EXPECT_THAT(ran_, IsEmpty());
  EXPECT_EQ(ReadWhole(Path("out/fleet/seed-2/thesis.tex")), "years of work");
}

TEST_F(BatchTest, TwoAtOnceAreRefused) {
  std::string message;
  options_.on_finished = [&](const BatchProgress&) {
    if (!message.empty()) return;
    BatchOptions second = options_;
    second.on_finished = nullptr;
    try {
      RunBatch(PlanBatch({Path("fleet.yaml")}), second);
    } catch (const InputError& error) {
      message = error.what();
    }
  };
  EXPECT_EQ(Run({"fleet.yaml"}).Count(BatchStatus::kDone), 3);
  EXPECT_THAT(message, HasSubstr("another batch is writing"));
}

// The way through a file: `alidade simulate`, then a job on what it wrote.
TEST_F(BatchTest, SimulatedDataAreThoseThatAFileWouldHold) {
  WriteWhole(Path("simulation.yaml"),
             "format: alidade-simulation-1\n"
             "units: {length: mm, angle: rad}\n"
             "arm: arm.yaml\n"
             "deviations: " +
                 kSource +
                 "/configs/robots/rv2aj_deviations.yaml\n"
                 "poses: {random: {count: 12}}\n"
                 "noise: {sigma: 0.05}\n"
                 "seed: 1\n"
                 "output: data.csv\n");
  const SimulationConfig simulation = LoadSimulation(Path("simulation.yaml"));
  WriteWhole(Path("data.csv"),
             FormatDataset(Simulate(simulation), simulation.arm,
                           simulation.joint_decimals, true, {}));
  WriteWhole(Path("made_up.yaml"),
             "format: alidade-job-1\nextends: fleet.yaml\nmatrix: ~\n"
             "data: {simulate: {noise: {sigma: 0.05}}}\n");
  WriteWhole(Path("from_file.yaml"),
             "format: alidade-job-1\nextends: fleet.yaml\nmatrix: ~\n"
             "data: {simulate: ~, file: data.csv}\n");
  const Dataset made_up = LoadJob(Path("made_up.yaml")).data.training;
  const Dataset from_file = LoadJob(Path("from_file.yaml")).data.training;
  EXPECT_EQ(made_up.joint_values, from_file.joint_values);
  EXPECT_EQ(made_up.sigmas(), from_file.sigmas());
  // Positions of about 0.5 m are written in mm, to the digits that read back.
  EXPECT_LT((made_up.positions().map() - from_file.positions().map())
                .cwiseAbs()
                .maxCoeff(),
            2e-16);
}

TEST_F(BatchTest, AFolderGivesItsJobsAndNothingElse) {
  // arm.yaml, in the same folder, is no job.
  WriteWhole(Path("_base.yaml"), kJob);
  WriteWhole(Path("b.yml"), "format: alidade-job-1\nextends: _base.yaml\n");
  WriteWhole(Path("damaged.yaml"), "format: [");
  const BatchPlan plan = PlanBatch({directory_.path().string()});
  std::vector<std::string> names;
  for (const PlannedJob& job : plan.jobs) names.push_back(job.name);
  EXPECT_THAT(names, ElementsAre("b", "damaged", "fleet/seed-1", "fleet/seed-2",
                                 "fleet/seed-3"));
  EXPECT_THAT(plan.jobs[1].error, Not(IsEmpty()));
  fs::create_directories(Path("empty"));
  EXPECT_THROW(PlanBatch({Path("empty")}), InputError);
}

TEST_F(BatchTest, TwoJobsOfOneNameAreRefused) {
  WriteWhole(Path("below/fleet.yaml"), kJob);
  EXPECT_THROW(PlanBatch({Path("fleet.yaml"), Path("fleet.yaml")}), InputError);
  // "fleet" would hold "fleet/seed-1".
  EXPECT_THROW(PlanBatch({Path("below/fleet.yaml"), Path("fleet.yaml")}),
               InputError);
}

TEST_F(BatchTest, AListNamesJobsFromItsOwnFolder) {
  WriteWhole(Path("below/list.txt"),
             "# a comment\n\n ../fleet.yaml \r\n/a/b\n");
  EXPECT_THAT(ReadJobList(Path("below/list.txt")),
              ElementsAre(Path("fleet.yaml"), "/a/b"));
  WriteWhole(Path("list.txt"), "# nothing\n");
  EXPECT_THROW(ReadJobList(Path("list.txt")), InputError);
}

}  // namespace
}  // namespace alidade::internal
