// No command replaces or removes what is not its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::overwrite_test {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
const std::string kArm = kSource + "/configs/robots/rv2aj_wrist.yaml";
const std::string kData = kSource + "/datasets/rv2aj/wrist_56.csv";

// An arm, its data, a job and a simulation in a folder of their own.
class OverwriteTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy_file(kArm, directory_ / "arm.yaml");
    fs::copy_file(kData, directory_ / "data.csv");
    Write("job.yaml",
          "format: alidade-job-1\ntitle: Arm\n"
          "units: {length: mm, angle: rad}\narm: arm.yaml\ndata: data.csv\n"
          "measurement: {sigma: 0.01}\n");
    Write("sim.yaml",
          "format: alidade-simulation-1\ntitle: Arm\n"
          "units: {length: mm, angle: rad}\narm: arm.yaml\n"
          "poses: {random: {count: 5}}\nnoise: {sigma: 0.01}\nseed: 1\n"
          "output: simulated.csv\n");
    Write("plan.yaml",
          "format: alidade-plan-1\ntitle: Poses\n"
          "units: {length: mm, angle: rad}\narm: arm.yaml\n"
          "measurement: {kind: position, sigma: 0.02}\nposes: {count: 12}\n"
          "candidates: {count: 100}\nseed: 3\n"
          "identifiability: {policy: keep}\n");
  }

  void Write(const std::string& name, const std::string& text) const {
    fs::create_directories(fs::path(directory_ / name).parent_path());
    WriteWhole(directory_ / name, text);
  }
  std::string Read(const std::string& name) const {
    return ReadWhole(directory_ / name);
  }

  ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }
  void Run(const std::string& arguments) const {
    const ProcessResult result = Alidade(arguments);
    ASSERT_EQ(result.status, 0) << arguments << ": " << result.err;
  }

  // The command ends with 2 and these words, prints no results, and `file` is
  // what it was.
  void ExpectRefused(const std::string& arguments, const std::string& file,
                     const std::string& words) const {
    const std::string before = Read(file);
    const ProcessResult result = Alidade(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_THAT(result.out, IsEmpty()) << arguments;
    EXPECT_THAT(result.err, AllOf(HasSubstr(file + ": "), HasSubstr(words),
                                  HasSubstr("another --out")))
        << arguments;
    EXPECT_EQ(Read(file), before) << arguments;
  }

  TemporaryDirectory directory_;
};

constexpr char kInput[] = "is read by this";
constexpr char kForeign[] = "is not known as written by alidade";
constexpr char kChanged[] = "has been changed since";

TEST_F(OverwriteTest, NoInputIsReplaced) {
  ExpectRefused("calibrate job.yaml --out=.", "arm.yaml", kInput);
  EXPECT_FALSE(fs::exists(directory_ / "result.json"));
  for (const char* input : {"sim.yaml", "arm.yaml"}) {
    ExpectRefused("simulate sim.yaml --out=" + std::string(input), input,
                  kInput);
  }
  fs::create_symlink("data.csv", directory_ / "link.npy");
  ExpectRefused("convert data.csv link.npy --arm=arm.yaml", "link.npy", kInput);
}

// The input stands where an earlier result had a file of its own.
TEST_F(OverwriteTest, NoInputIsRemoved) {
  Run("calibrate job.yaml --out=res");
  Write("res/job.yaml", Read("job.yaml"));
  fs::copy_file(directory_ / "data.csv", directory_ / "res/data.csv");
  for (const char* command : {"compare", "montecarlo", "calibrate"}) {
    ExpectRefused(command + std::string(" res/job.yaml --out=res"),
                  "res/arm.yaml", kInput);
  }
  ExpectRefused("validate res data.csv --out=res", "res/arm.yaml", kInput);
}

TEST_F(OverwriteTest, FilesOfOthersAreNotReplaced) {
  Write("pp/poses.csv", "precious");
  Write("res/report.txt", "precious");
  Write("cmp/iterations.csv", "precious");
  Write("page.html", "precious");
  ExpectRefused("plan plan.yaml --out=pp", "pp/poses.csv", kForeign);
  ExpectRefused("calibrate job.yaml --out=res", "res/report.txt", kForeign);
  ExpectRefused("compare job.yaml --out=cmp", "cmp/iterations.csv", kForeign);
  Run("calibrate job.yaml --out=good");
  ExpectRefused("report good --out=page.html", "page.html", kForeign);
  Write("good/notes.txt", "stay");
  Run("calibrate job.yaml --out=good");
  EXPECT_EQ(Read("good/notes.txt"), "stay");
}

TEST_F(OverwriteTest, ResultsThatWereChangedAreKept) {
  Run("calibrate job.yaml --report --out=res");
  Run("calibrate job.yaml --report --out=res");
  Run("report res");
  Run("report res");
  Run("calibrate job.yaml --out=res");  // removes the page
  Write("res/report.txt", Read("res/report.txt") + "my notes\n");
  ExpectRefused("calibrate job.yaml --out=res", "res/report.txt", kChanged);
  ExpectRefused("compare job.yaml --out=res", "res/report.txt", kChanged);
}

// Copies have other times, and lists of earlier versions names alone.
TEST_F(OverwriteTest, CopiesAndOldDirectoriesAreReplaced) {
  Run("calibrate job.yaml --out=res");
  fs::copy(directory_ / "res", directory_ / "copy");
  for (const auto& entry : fs::directory_iterator(directory_ / "copy")) {
    fs::last_write_time(entry.path(), fs::file_time_type::clock::now() -
                                          std::chrono::hours(24));
  }
  Run("calibrate job.yaml --out=copy");
  Write("res/.alidade-files", "arm.yaml\nreport.txt\n");
  Write("res/report.txt", "old");
  ExpectRefused("calibrate job.yaml --out=res", "res/budget.csv", kForeign);
  std::string names;
  for (const auto& entry : fs::directory_iterator(directory_ / "res")) {
    names += entry.path().filename().string() + "\n";
  }
  Write("res/.alidade-files", names);
  Run("calibrate job.yaml --out=res");
}

TEST_F(OverwriteTest, BatchesKeepWhatIsNotTheirs) {
  Write("out/summary.csv", "precious");
  ExpectRefused("batch job.yaml --out=out", "out/summary.csv", kForeign);
  fs::remove(directory_ / "out/summary.csv");
  Run("batch job.yaml --out=out");
  Run("batch job.yaml --out=out");
  Write("out/job/notes.txt", "stay");
  ExpectRefused("batch job.yaml --out=out", "out/job/notes.txt", kForeign);
  fs::remove(directory_ / "out/job/notes.txt");
  Write("out/job/arm.yaml", Read("out/job/arm.yaml") + "# mine\n");
  ExpectRefused("batch job.yaml --out=out", "out/job/arm.yaml", kChanged);
}

// A batch of an earlier version has no lists, but a journal.
TEST_F(OverwriteTest, OldBatchesGoOn) {
  Run("batch job.yaml --out=out");
  fs::remove(directory_ / "out/.alidade-files");
  fs::remove(directory_ / "out/job/.alidade-files");
  Write("job.yaml", Read("job.yaml") + "outputs: minimal\n");
  Run("batch job.yaml --out=out");
  EXPECT_FALSE(fs::exists(directory_ / "out/job/report.txt"));
}

TEST_F(OverwriteTest, BatchesDoNotReplaceWhatTheyRead) {
  Run("batch job.yaml --out=out");
  std::string job = Read("job.yaml");
  job.replace(job.find("arm.yaml"), 8, "out/job/arm.yaml");
  Write("job.yaml", job);
  ExpectRefused("batch job.yaml --out=out", "out/job/arm.yaml", kInput);
}

}  // namespace
}  // namespace alidade::internal::overwrite_test
