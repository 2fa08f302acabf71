// Messages about files that are not what a command takes, or slips that people
// make in them: what is wrong, where, and what to do.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/process.h"

namespace alidade::internal::messages_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;
using testing::TemporaryDirectory;
using testing::WriteWhole;

constexpr char kJob[] =
    "format: alidade-job-1\ntitle: Arm\nunits: {length: mm, angle: deg}\n"
    "arm: " ALIDADE_SOURCE_DIR
    "/configs/robots/rv2aj_wrist.yaml\n"
    "data: " ALIDADE_SOURCE_DIR "/datasets/rv2aj/wrist_56.csv\n";

struct Slip {
  const char* name;
  const char* file;
  std::string text;
  const char* command;
  const char* message;
};

class MessageTest : public ::testing::TestWithParam<Slip> {};

TEST_P(MessageTest, SaysWhatIsWrongAndWhatToDo) {
  const Slip& slip = GetParam();
  const TemporaryDirectory directory;
  WriteWhole(directory / slip.file, slip.text);
  const ProcessResult result =
      testing::RunIn(directory.path(), std::string(ALIDADE_BINARY) + " " +
                                           slip.command + " " + slip.file);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr(slip.message));
}

constexpr char kCheckData[] =
    "check " ALIDADE_SOURCE_DIR "/configs/robots/rv2aj_wrist.yaml";

INSTANTIATE_TEST_SUITE_P(
    All, MessageTest,
    ::testing::Values(
        Slip{"ResultToCheck", "result.json",
             "{\"format\": \"alidade-result-2\"}", "check",
             "`alidade show`, `validate` and `report` take results"},
        Slip{"PlanResultToCheck", "plan.json",
             "{\"format\": \"alidade-plan-result-2\"}", "check",
             "plan.txt beside it says it in words"},
        Slip{"PlanResultToShow", "plan.json",
             "{\"format\": \"alidade-plan-result-2\"}", "show",
             "plan.txt beside it says it in words"},
        Slip{"PlanToShow", "plan.yaml", "format: alidade-plan-1\n", "show",
             "`alidade plan` takes plans"},
        Slip{"SimulationToCalibrate", "s.yaml",
             "format: alidade-simulation-1\n", "calibrate",
             "`alidade simulate` takes simulations"},
        Slip{"DeviationsToShow", "dev.yaml", "format: alidade-deviations-1\n",
             "show", "deviations are named by jobs (`truth`)"},
        Slip{"FolderToShow", "notes.txt", "", "show .", "has no result.json"},
        Slip{"DecimalComma", "job.yaml",
             kJob + std::string("measurement: {sigma: 0,03}\n"), "check",
             "write a decimal point, not a comma"},
        Slip{"NegativePrior", "job.yaml",
             kJob + std::string("measurement: {sigma: 0.03}\n"
                                "identifiability: {priors: {d: -1}}\n"),
             "check",
             "job.yaml:7:31: identifiability.priors.d: expected a length above "
             "0, found -1"},
        Slip{"ForeignColumn", "data.csv", "J1,x_mm,y_mm,z_mm\n1,2,3,4\n",
             kCheckData,
             "the arm's joints are q1_deg to q5_deg. `columns` in the job's"},
        Slip{"NoHeader", "data.csv", "3.901,1,2\n3.2,1,2\n", kCheckData,
             "data.csv:1:1: found the number \"3.901\", expected a line of "
             "column names first"},
        Slip{"NoBlankAfterAColon", "job.yaml",
             "format: alidade-job-1\ntitle:Arm\nunits: {length: mm}\n", "check",
             "Line 2 has no blank after the colon: write \"title: Arm\""},
        Slip{"ColonInAText", "job.yaml",
             "format: alidade-job-1\ntitle: UR10: lab\n", "check",
             "quote that, \"title: 'UR10: lab'\""},
        Slip{"Tab", "job.yaml", "format: alidade-job-1\ndata:\n\tfile: a\n",
             "check", "Line 3 begins with a tab: YAML takes blanks"},
        Slip{"Indentation", "job.yaml",
             "format: alidade-job-1\ntitle: Arm\n  arm: a\n", "check",
             "Line 3 begins 2 blanks from the left, line 2 0"},
        Slip{"IndentationBelowAComment", "job.yaml",
             "format: alidade-job-1\ntitle: Arm # see: a\n  arm: a\n", "check",
             "Line 3 begins 2 blanks from the left, line 2 0"},
        Slip{"EndOfMap", "job.yaml",
             "format: alidade-job-1\ndata:\n   file: a\n  point: b\n", "check",
             "Line 4 begins 2 blanks from the left, line 3 3"},
        Slip{"KeysThatBeginEarlier", "job.yaml",
             "  format: alidade-job-1\ntitle: Arm\n", "check",
             "or this key begins in another column than the first"},
        Slip{"ColumnsBesideData", "job.yaml",
             kJob + std::string("columns: {joints: [a, b, c, d, e]}\n"),
             "check",
             "It belongs in `data`: `data: {file: ..., columns: ...}`"},
        Slip{"TableToCheck", "faro.csv", "J1,X\n1,2\n", "check",
             "'alidade check robots/ur10e faro.csv'"},
        Slip{"Spaces", "data.csv", "q1_deg q2_deg x_mm\n1 2 3\n", kCheckData,
             "data set has 2 joints, arm"}),
    [](const auto& slip) { return slip.param.name; });

TEST(YamlMessageTest, TextsOfManyLinesAreNotBlamed) {
  const TemporaryDirectory directory;
  WriteWhole(directory / "job.yaml",
             "format: alidade-job-1\ntitle: |\n  see: UR10: lab\n arm: a\n");
  const ProcessResult result = testing::RunIn(
      directory.path(), std::string(ALIDADE_BINARY) + " check job.yaml");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("not valid YAML"));
  EXPECT_THAT(result.err, Not(HasSubstr("has a colon in its text")));
}

TEST(FolderMessageTest, NamesTheFileInIt) {
  const TemporaryDirectory directory;
  WriteWhole(directory / "job.yaml", kJob);
  const std::string program = std::string(ALIDADE_BINARY) + " ";
  const ProcessResult job =
      testing::RunIn(directory.path(), program + "calibrate .");
  EXPECT_EQ(job.status, 2);
  EXPECT_THAT(job.err, HasSubstr(". is a folder, expected a job, which is a "
                                 "YAML file: ./job.yaml"));
  EXPECT_THAT(testing::RunIn(directory.path(), program + "plan .").err,
              HasSubstr(". is a folder, expected a plan, which is a YAML "
                        "file;"));
}

}  // namespace
}  // namespace alidade::internal::messages_test
