#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "src/serialization/described_formats.h"
#include "tests/report/well_formed.h"
#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal::cli_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using ::testing::StartsWith;
using testing::TemporaryDirectory;
using testing::WithoutTimes;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
const std::string kStudy = kSource + "/configs/jobs/rv2aj_study.yaml";
const std::string kFlangeJob = kSource + "/configs/jobs/rv2aj_flange.yaml";
const std::string kWristArm = kSource + "/configs/robots/rv2aj_wrist.yaml";
const std::string kWristData = kSource + "/datasets/rv2aj/wrist_56.csv";

ProcessResult Alidade(const std::string& arguments) {
  return testing::RunProcess(std::string(ALIDADE_BINARY) + " " + arguments);
}

TEST(CliTest, WithoutCommandPrintsUsageAndExitsWithTwo) {
  const ProcessResult result = Alidade("");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr("usage: alidade COMMAND"));
}

TEST(CliTest, HelpNamesEveryCommandOnStandardOutput) {
  const ProcessResult result = Alidade("--help");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* command :
       {"robots", "keys", "show", "check", "convert", "simulate", "plan",
        "identify", "calibrate", "compare", "montecarlo", "validate", "correct",
        "export", "fk", "ik", "report", "batch"}) {
    EXPECT_THAT(result.out, HasSubstr(command));
    const ProcessResult help = Alidade(std::string(command) + " --help");
    EXPECT_EQ(help.status, 0) << command;
    EXPECT_THAT(help.out, HasSubstr(std::string("usage: alidade ") + command));
    EXPECT_THAT(help.out, HasSubstr("--threads"));
  }
}

TEST(CliTest, HelpNamesACommandAndTheDocumentation) {
  EXPECT_EQ(Alidade("help calibrate").out, Alidade("calibrate --help").out);
  EXPECT_THAT(Alidade("help calibrat").err, HasSubstr("did you mean"));
  EXPECT_THAT(Alidade("--help").out,
              HasSubstr("\nDocumentation: " + kSource + "\n"));
  EXPECT_THAT(Alidade("import --help").out,
              HasSubstr("Pages that are named here are in " + kSource + "\n"));
}

TEST(CliTest, VersionIsPrinted) {
  const ProcessResult result = Alidade("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(std::regex_match(
      result.out,
      std::regex("alidade [0-9.]+\n(commit .*\n)?build .*\n(.*\n)?")));
}

struct BadUsage {
  const char* arguments;
  const char* message;
};

class CliBadUsageTest : public ::testing::TestWithParam<BadUsage> {};

TEST_P(CliBadUsageTest, ExitsWithTwoAndSaysWhy) {
  const ProcessResult result = Alidade(GetParam().arguments);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    All, CliBadUsageTest,
    ::testing::Values(
        BadUsage{"fly", "unknown command \"fly\""},
        BadUsage{"calibrate", "expected JOB.yaml"},
        BadUsage{"calibrate a.yaml b.yaml", "too many files"},
        BadUsage{"calibrate --wings=2 a.yaml", "unknown flag --wings=2"},
        BadUsage{"show --out=x a.yaml", "unknown flag --out=x"},
        BadUsage{"calibrat a.yaml", "did you mean \"calibrate\"?"},
        BadUsage{"calibrate --raport a.yaml", "did you mean --report?"},
        BadUsage{"calibrate a.csv", "'alidade import' makes one of it"},
        BadUsage{"calibrate --threads=many a.yaml", "not a value"},
        BadUsage{"calibrate --threads=0 a.yaml", "must be between"},
        BadUsage{"calibrate --verbosity=3 a.yaml", "must be 0, 1 or 2"},
        BadUsage{"show --verbosity=-1 a.yaml", "must be 0, 1 or 2"},
        BadUsage{"calibrate a.yaml --seed", "needs a value"},
        BadUsage{"convert a.csv b.npy", "--arm=ARM.yaml is missing"},
        BadUsage{"convert a.csv b.csv --arm=a.yaml", "one of each"},
        BadUsage{"convert a.csv b.txt --arm=a.yaml", "ends in .csv or .npy"},
        BadUsage{"calibrate no_such_file.yaml", "no_such_file.yaml"},
        BadUsage{"keys jub", "unknown format \"jub\", did you mean \"job\"?"},
        BadUsage{"keys job.data", "'alidade keys data' lists"},
        BadUsage{"export a.yaml", "--as=FORMAT is missing, expected one of dh"},
        BadUsage{"fk a.yaml 0 -90", "too many files, expected ARM.yaml"},
        BadUsage{"keys job.uncertainy", "did you mean \"uncertainty\"?"},
        BadUsage{"show /", "/"}));

// Every key of every format, from the descriptions that its reader goes by.
TEST(CliTest, KeysAreThoseOfTheDescriptions) {
  for (const DescribedFormat& format : DescribeFormats()) {
    const ProcessResult result = Alidade("keys " + format.name);
    EXPECT_EQ(result.status, 0);
    std::size_t place = 0;
    for (const FieldRow& row : FieldRows(format.fields)) {
      const std::string line = "  " + row.path;
      place = result.out.find(line, place);
      ASSERT_NE(place, std::string::npos) << format.name << ": " << row.path;
    }
  }
  const ProcessResult section = Alidade("keys job.uncertainty");
  EXPECT_THAT(section.out, StartsWith("  confidence  (0.95)\n      of "));
  EXPECT_THAT(Alidade("keys").out, HasSubstr("  job         sections "));
  EXPECT_THAT(Alidade("keys job").out, HasSubstr("(docs/batch.md)"));
}

// Of a file that a calibration of the study wrote: figures are XML with
// something drawn, tables have as many cells in each row and as many rows as
// there were poses (56 fitted, 3600 held out), or any. Empty: nothing.
std::string WhatIsWrongWith(const std::filesystem::path& path) {
  const std::string text = ReadWhole(path);
  const std::string name = path.filename().string();
  if (path.extension() == ".svg") {
    const std::string wrong = WhatIsMalformed(text);
    if (!wrong.empty()) return name + ": " + wrong;
    const bool is_drawn =
        std::regex_search(text, std::regex("<(circle|path|polyline|rect)"));
    const bool says_no_data = text.find("no data") != std::string::npos;
    return is_drawn && !says_no_data ? "" : name + ": nothing is drawn";
  }
  if (path.extension() != ".csv") return text.empty() ? name + ": empty" : "";
  std::istringstream lines(text);
  std::string header;
  std::getline(lines, header);
  const auto commas = std::count(header.begin(), header.end(), ',');
  int rows = 0;
  for (std::string line; std::getline(lines, line); ++rows) {
    if (std::count(line.begin(), line.end(), ',') != commas) {
      return name + ": row " + std::to_string(rows + 1) + " is " + line;
    }
  }
  const std::map<std::string, int> expected = {
      {"residuals.csv", 56}, {"influence.csv", 56}, {"validation.csv", 3600}};
  const auto found = expected.find(name);
  const bool is_right =
      found == expected.end() ? rows > 0 : rows == found->second;
  return is_right ? "" : name + ": " + std::to_string(rows) + " rows";
}

class StudyTest : public ::testing::Test {
 protected:
  TemporaryDirectory directory_;
};

TEST_F(StudyTest, CalibrateWritesTheWholeResultDirectory) {
  const std::string out = directory_ / "new/results";
  const ProcessResult result = Alidade("calibrate " + kStudy + " --out=" + out);
  ASSERT_EQ(result.status, 0) << result.err;
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    const std::string name = entry.path().filename().string();
    if (name == ".alidade-files") continue;
    names.insert(name);
    EXPECT_EQ(WhatIsWrongWith(entry.path()), "");
    EXPECT_THAT(result.out, HasSubstr(entry.path().string()));
  }
  EXPECT_EQ(
      names,
      (std::set<std::string>{
          "arm.yaml", "convergence.svg", "error_after.svg", "error_before.svg",
          "validation.csv", "validation_z_scores.svg", "influence.csv",
          "iterations.csv", "budget.csv", "predicted_map.csv",
          "predicted_map.svg", "report.txt", "residual_histogram.svg",
          "residuals.csv", "result.json", "singular_values.svg",
          "validation_after.svg", "validation_before.svg"}));
}

TEST_F(StudyTest, CalibrateEndsOnPublishedAgainstObtainedAndThePaths) {
  const std::string out = directory_ / "results";
  const ProcessResult result = Alidade("calibrate " + kStudy + " --out=" + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("Published: Etalonnage"),
                                HasSubstr("160.100000  160.100400")));
  EXPECT_GT(result.out.find("result.json"), result.out.find("160.100400"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("warning"), HasSubstr("beta4")));
}

TEST_F(StudyTest, ResultDoesNotDependOnThreadsOrTheRun) {
  const std::string first = directory_ / "first";
  ASSERT_EQ(Alidade("calibrate " + kStudy + " --out=" + first).status, 0);
  for (const char* threads : {"1", "2", "8"}) {
    const std::string again = directory_ / (std::string("again") + threads);
    ASSERT_EQ(Alidade("calibrate " + kStudy + " --threads=" + threads +
                      " --out=" + again)
                  .status,
              0);
    for (const char* name :
         {"arm.yaml", "residuals.csv", "validation.csv", "error_before.svg",
          "error_after.svg", "convergence.svg", "validation_before.svg",
          "validation_after.svg"}) {
      EXPECT_EQ(ReadWhole(first + "/" + name), ReadWhole(again + "/" + name))
          << name << " with " << threads << " threads";
    }
    EXPECT_EQ(WithoutTimes(first + "/result.json"),
              WithoutTimes(again + "/result.json"));
  }
}

TEST_F(StudyTest, CalibratedArmIsAnArmThatValidatesAndShows) {
  const std::string out = directory_ / "results";
  ASSERT_EQ(Alidade("calibrate " + kStudy + " --out=" + out).status, 0);
  const std::string arm = out + "/arm.yaml";
  EXPECT_EQ(Alidade("check " + arm).status, 0);
  const ProcessResult validated = Alidade("validate " + arm + " " + kWristData);
  ASSERT_EQ(validated.status, 0) << validated.err;
  EXPECT_TRUE(std::regex_search(validated.out,
                                std::regex("wrist_56.csv +56 .*e-1[34]\n")))
      << validated.out;
  EXPECT_THAT(Alidade("show " + arm).out, HasSubstr("249"));
  EXPECT_THAT(Alidade("show " + out).out, HasSubstr("beta4"));
}

// Standard output stays what it is.
TEST_F(StudyTest, VerbosityTellsWhatIsDoneOnStandardError) {
  const std::string job = "identify " + kStudy;
  const ProcessResult quiet = Alidade(job);
  const ProcessResult told = Alidade(job + " --verbosity=1");
  const ProcessResult detailed = Alidade(job + " --verbosity=2");
  EXPECT_THAT(quiet.err, Not(HasSubstr("read 56 poses")));
  EXPECT_EQ(quiet.out, told.out);
  EXPECT_EQ(quiet.out, detailed.out);
  EXPECT_THAT(told.err, AllOf(HasSubstr("read 56 poses"),
                              HasSubstr("parameters are free"),
                              Not(HasSubstr("wrist_56.csv"))));
  EXPECT_THAT(detailed.err,
              AllOf(HasSubstr("read 56 poses"), HasSubstr("wrist_56.csv")));
  const ProcessResult calibrated = Alidade(
      "calibrate " + kStudy + " --verbosity=1 --out=" + (directory_ / "r"));
  EXPECT_THAT(calibrated.err,
              AllOf(HasSubstr("read 56 poses"), HasSubstr("solved: ceres")));
}

TEST_F(StudyTest, IdentifySaysWhatIsFixedAndWhy) {
  const ProcessResult result = Alidade("identify " + kStudy);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("r2 + r3 + r4"), HasSubstr("column is zero"),
                    HasSubstr("beta4 is linearly dependent on -160 mm * r2")));
}

TEST_F(StudyTest, UnitsOfTheFilesDoNotChangeTheAnalysis) {
  // The same arm and data in metres: every length of
  // the wrist arm is a whole number of millimetres.
  std::string arm = ReadWhole(kWristArm);
  arm = std::regex_replace(arm, std::regex("length: mm"), "length: m");
  for (const char* length : {"300", "250", "160"}) {
    arm = std::regex_replace(arm,
                             std::regex(std::string("([dr]): ") + length + " "),
                             std::string("$1: 0.") + length + " ");
  }
  WriteWhole(directory_ / "arm_m.yaml", arm);
  const ProcessResult metres =
      Alidade("identify " + (directory_ / "arm_m.yaml") + " " + kWristData);
  ASSERT_EQ(metres.status, 0) << metres.err;
  EXPECT_EQ(metres.out,
            Alidade("identify " + kWristArm + " " + kWristData).out);
}

TEST_F(StudyTest, FlangeIsRefusedWithoutAChoiceAndSolvedWithOne) {
  std::string job = ReadWhole(kFlangeJob);
  job = std::regex_replace(job, std::regex("\\.\\./\\.\\./datasets"),
                           kSource + "/datasets");
  job = std::regex_replace(job, std::regex("\\.\\./robots"),
                           kSource + "/configs/robots");
  const std::string without =
      std::regex_replace(job, std::regex("fix: *\\[[^\\]]*\\]"), "fix: []");
  ASSERT_NE(job, without);
  WriteWhole(directory_ / "free.yaml", without);
  const std::string out = directory_ / "results";
  const ProcessResult refused =
      Alidade("calibrate " + (directory_ / "free.yaml") + " --out=" + out);
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("theta4"), HasSubstr("alpha5"),
                                 HasSubstr("proceed_beyond_rank")));
  EXPECT_FALSE(std::filesystem::exists(out));
  const ProcessResult solved =
      Alidade("calibrate " + kFlangeJob + " --out=" + out);
  EXPECT_EQ(solved.status, 0) << solved.err;
}

TEST_F(StudyTest, CompareShowsBothSolvers) {
  const ProcessResult result = Alidade("compare " + kStudy);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("Levenberg-Marquardt"),
                                HasSubstr("pseudo-inverse"),
                                HasSubstr("stopped at the numerical")));
}

TEST_F(StudyTest, MissedAcceptanceLimitExitsWithOneAndStillWrites) {
  std::string job = ReadWhole(kStudy);
  job = std::regex_replace(job, std::regex("\\.\\./\\.\\./datasets"),
                           kSource + "/datasets");
  job = std::regex_replace(job, std::regex("\\.\\./robots"),
                           kSource + "/configs/robots");
  job = std::regex_replace(job, std::regex("train_max: *[0-9.e-]+"),
                           "train_max: 1e-15");
  WriteWhole(directory_ / "strict.yaml", job);
  const std::string out = directory_ / "results";
  const ProcessResult result =
      Alidade("calibrate " + (directory_ / "strict.yaml") + " --out=" + out);
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("acceptance limit"));
  EXPECT_TRUE(std::filesystem::exists(out + "/result.json"));
}

TEST_F(StudyTest, SimulateRepeatsTheCommittedDataSetsToTheByte) {
  for (const std::string arm_and_name :
       {"rv2aj wrist_56", "rv2aj wrist_3600", "rv2aj flange_56",
        "rv2aj flange_3600", "kr6 tracker"}) {
    const std::size_t space = arm_and_name.find(' ');
    const std::string arm = arm_and_name.substr(0, space);
    const std::string name = arm_and_name.substr(space + 1);
    const std::string out = directory_ / (name + ".csv");
    const ProcessResult result =
        Alidade("simulate " + kSource + "/configs/simulations/" + arm + "_" +
                name + ".yaml --out=" + out);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(ReadWhole(out),
              ReadWhole(kSource + "/datasets/" + arm + "/" + name + ".csv"))
        << name;
  }
}

TEST_F(StudyTest, AnotherSeedGivesOtherPoses) {
  const std::string config =
      kSource + "/configs/simulations/rv2aj_wrist_56.yaml";
  const std::string out = directory_ / "other.csv";
  ASSERT_EQ(Alidade("simulate " + config + " --seed=77 --out=" + out).status,
            0);
  EXPECT_NE(ReadWhole(out), ReadWhole(kWristData));
}

TEST_F(StudyTest, CheckLooksAtAllFilesAndNamesTheWrongOne) {
  WriteWhole(directory_ / "bad.yaml",
             "format: alidade-arm-1\nname: x\nunits: {length: deg}\n");
  const ProcessResult result =
      Alidade("check " + (directory_ / "bad.yaml") + " " + kWristArm + " " +
              kWristData + " " + kStudy);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("bad.yaml:3:"));
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("arm, 5 joints"), HasSubstr("56 poses")));
  // Whole lines alone: none begins with the name of the file that is wrong.
  EXPECT_EQ(result.out.rfind(kWristArm + ": arm", 0), 0U) << result.out;
}

TEST_F(StudyTest, EveryFileInConfigsChecks) {
  std::string arm_first = kWristArm;
  std::string files;
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(kSource + "/configs")) {
    if (!entry.is_regular_file()) continue;
    // Their data are not part of the project.
    if (entry.path().parent_path().filename() == "real_arms") continue;
    // Many jobs each: `batch` reads them.
    if (entry.path().parent_path().filename() == "batches") continue;
    // Deviations are read with the arm before them.
    if (entry.path().filename() == "kr6_deviations.yaml") {
      files += " " + (entry.path().parent_path() / "kr6_cell.yaml").string() +
               " " + entry.path().string() + " " + arm_first;
    } else {
      files += " " + entry.path().string();
    }
    ++count;
  }
  ASSERT_GE(count, 9);
  const ProcessResult result = Alidade("check " + arm_first + files);
  EXPECT_EQ(result.status, 0) << result.err;
  const ProcessResult batches =
      Alidade("batch --dry-run " + kSource +
              "/configs/batches --out=" + (directory_ / "batch"));
  EXPECT_EQ(batches.status, 0) << batches.err;
}

TEST_F(StudyTest, WrongDataLeavesNoOutput) {
  WriteWhole(directory_ / "data.csv",
             "q1_deg,q2_deg,x_mm,y_mm,z_mm\n0,0,0,0,0\n");
  const ProcessResult result =
      Alidade("identify " + kWristArm + " " + (directory_ / "data.csv"));
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr("data.csv"));
}

TEST_F(StudyTest, UnwritableOutputIsAnErrorOfTheUser) {
  WriteWhole(directory_ / "file", "not a directory");
  const ProcessResult result = Alidade(
      "calibrate " + kStudy + " --out=" + (directory_ / "file/results"));
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("file"));
}

TEST_F(StudyTest, ValidateTellsWhetherErrorsAreAsPredicted) {
  const std::string out = directory_ / "results";
  ASSERT_EQ(Alidade("calibrate " + kStudy + " --out=" + out).status, 0);
  const ProcessResult result =
      Alidade("validate " + out + " " + kSource +
              "/datasets/rv2aj/wrist_3600.csv --out=" + out + "/check");
  ASSERT_EQ(result.status, 0) << result.err;
  // The study's data are exact, its sigma is not.
  EXPECT_THAT(result.out, AllOf(HasSubstr("smaller than"), HasSubstr("3600"),
                                HasSubstr("Predicted standard deviation"),
                                HasSubstr("check/z_scores.svg")));
  const ProcessResult arm =
      Alidade("validate " + out + "/arm.yaml " + kSource +
              "/datasets/rv2aj/wrist_3600.csv --out=" + out + "/check");
  EXPECT_EQ(arm.status, 2);
  EXPECT_THAT(arm.err, HasSubstr("result directory"));
}

TEST_F(StudyTest, MonteCarloPrintsCoverageAndWritesItsFiles) {
  const std::string job = directory_ / "job.yaml";
  const std::string text =
      "format: alidade-job-1\ntitle: trials\n"
      "units: {length: mm, angle: rad}\narm: " +
      kSource + "/configs/robots/rv2aj_flange.yaml\ndata: " + kSource +
      "/datasets/rv2aj/flange_56.csv\nmeasurement: {sigma: 0.02}\n";
  WriteWhole(job, text +
                      "montecarlo: {trials: 30, truth: priors, "
                      "outliers: {fraction: 0.05, size: 1}}\n");
  const std::string out = directory_ / "trials";
  const ProcessResult result =
      Alidade("montecarlo " + job + " --threads=2 --out=" + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("30 simulated calibrations"),
                    HasSubstr("holds truth %"), HasSubstr("trials.csv")));
  // A header and a row for each trial.
  const std::string trials = ReadWhole(out + "/trials.csv");
  EXPECT_EQ(std::count(trials.begin(), trials.end(), '\n'), 31);
  WriteWhole(job, text + "montecarlo: {trials: 30, truth: given}\n");
  const ProcessResult wrong = Alidade("montecarlo " + job);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err,
              AllOf(HasSubstr("job.yaml:7:"), HasSubstr("montecarlo.truth")));
}

TEST_F(StudyTest, ValidateAgainstAnotherArmComparesWorkspaces) {
  const ProcessResult same = Alidade("validate " + kWristArm + " " + kWristArm);
  ASSERT_EQ(same.status, 0) << same.err;
  EXPECT_TRUE(std::regex_search(same.out, std::regex("10000 +0 +0 +0 +0")))
      << same.out;
  // The flange is 72 mm beyond the wrist centre at every joint value.
  const ProcessResult flange = Alidade("validate " + kWristArm + " " + kSource +
                                       "/configs/robots/rv2aj_flange.yaml");
  EXPECT_TRUE(std::regex_search(
      flange.out, std::regex("10000 +72.00 +72.00 +72.00 +72.00")))
      << flange.out;
}

}  // namespace
}  // namespace alidade::internal::cli_test
