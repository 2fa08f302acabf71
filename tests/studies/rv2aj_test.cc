#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "alidade/job.h"
#include "studies/rv2aj/format.h"
#include "studies/rv2aj/study.h"
#include "studies/rv2aj/study_report.h"
#include "tests/support/process.h"

namespace alidade::rv2aj {
namespace {

using internal::testing::ProcessResult;
using internal::testing::ReadWhole;
using internal::testing::RunProcess;
using internal::testing::TemporaryDirectory;
using internal::testing::WriteWhole;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kSource = ALIDADE_SOURCE_DIR;
const std::string kJob = kSource + "/configs/jobs/rv2aj_study.yaml";

// Words with one space between them.
std::string Flat(const std::string& text) {
  std::istringstream words(text);
  std::string flat;
  for (std::string word; words >> word;) {
    flat += (flat.empty() ? "" : " ") + word;
  }
  return flat;
}

StudyResult MakeStudy() {
  StudyResult study;
  study.source = "A study of <an> arm";
  study.rows = {
      {"after_max", "error after", "below 2e-13 mm", "2.1e-13 mm \"here\""}};
  study.parameters = {
      {"beta1", Dimension::kAngle, true, 0.0, 0.009, 0.009, 0.009},
      {"d4", Dimension::kLength, true, 0.16, 1e-4, 1e-4, 1.004e-4},
      {"r4", Dimension::kLength, false, 0.0, 1e-4, 0.0, 0.0}};
  study.absorptions = {
      {"r4", Dimension::kLength, 1e-4, "d4", Dimension::kLength, 0.004, 4e-7}};
  study.angle_decimals = 4;
  study.length_decimals = 1;
  study.full_precision = SummarizeErrors(Eigen::VectorXd::Constant(20, 3e-16));
  study.as_printed = SummarizeErrors(Eigen::VectorXd::Constant(20, 4e-7));
  study.three_more_decimals =
      SummarizeErrors(Eigen::VectorXd::Constant(20, 8e-10));
  study.timed_iterations = 100;
  study.timed_s = 0.01;
  study.published_s = 3543.0;
  return study;
}

std::string TextOf(const StudyResult& study) {
  return Flat(FormatSection(MakeStudySection(study, {})));
}

const StudyResult& RunStudy() {
  static const StudyResult kStudy = [] {
    const Job job = LoadJob(kJob);
    return CompareWithStudy(job, RunJob(job));
  }();
  return kStudy;
}

TEST(CompareWithStudyTest, D4TakesUpTheFixedR4) {
  const StudyResult& study = RunStudy();
  ASSERT_EQ(study.absorptions.size(), 1u);
  EXPECT_EQ(study.absorptions[0].fixed, "r4");
  EXPECT_EQ(study.absorptions[0].taken_up_by, "d4");
  EXPECT_NEAR(study.absorptions[0].coefficient, std::sin(0.004), 1e-7);
}

TEST(CompareWithStudyTest, PrintedTableIsFourTenthsOfAMicrometreOffEverywhere) {
  const StudyResult& study = RunStudy();
  EXPECT_NEAR(study.as_printed.min, 4.0000e-7, 0.5e-11);
  EXPECT_NEAR(study.as_printed.max, 4.0000e-7, 0.5e-11);
  EXPECT_NEAR(study.three_more_decimals.mean, 8.0e-10, 0.1e-10);
  EXPECT_EQ(study.timed_iterations, 100);
  EXPECT_GT(study.timed_s, 0.0);
}

TEST(StudySectionTest, HasBothTablesOfTheStudy) {
  const std::string flat = TextOf(MakeStudy());
  EXPECT_THAT(flat, HasSubstr("error after below 2e-13 mm 2.1e-13 mm"));
  // Table 1: joint 4 has d = 160 mm and r = 0.
  EXPECT_THAT(flat, HasSubstr("4 160.0000 0.0000"));
  EXPECT_THAT(flat, HasSubstr("beta1 rad 0.009000 0.0090 0.00900000 0 0 yes"));
  EXPECT_THAT(flat, HasSubstr("d4 mm 0.100000 0.1 0.100400 0 0.400 yes"));
  EXPECT_THAT(flat, HasSubstr("r4 mm 0.100000 0.0 0.000000 100 100 no"));
}

TEST(StudySectionTest, ExplainsWhatAFrozenParameterDoes) {
  EXPECT_THAT(
      TextOf(MakeStudy()),
      HasSubstr("d4 comes out as 0.100400 mm, not 0.100000 mm: it takes up the "
                "fixed r4 (0.1000 mm off its nominal value) with coefficient "
                "0.004000, that is 4.000e-04 mm. That explains the "
                "difference."));
}

TEST(StudySectionTest, ClaimsNoExplanationThatTheNumbersDoNotBear) {
  StudyResult study = MakeStudy();
  study.absorptions[0].amount = 1e-7;
  const std::string flat = TextOf(study);
  EXPECT_THAT(flat, Not(HasSubstr("explains")));
  EXPECT_THAT(flat, HasSubstr("Together that is 1.000e-04 mm to first order, "
                              "of 4.000e-04 mm."));
}

TEST(StudySectionTest, ExplainsThePrintedTable) {
  StudyResult study = MakeStudy();
  EXPECT_THAT(
      TextOf(study),
      AllOf(HasSubstr("angles to 4 decimals of a radian, lengths to 1 decimal "
                      "of a mm"),
            HasSubstr("4.0000e-04 mm (4.0e-07 m) in the mean, at most "
                      "4.0000e-04 mm, the same at every one of them."),
            HasSubstr("With 4 decimals of a mm it is 8.00e-07 mm"),
            HasSubstr("no limit of the calibration")));
  study.as_printed.min = 3e-7;
  study.full_precision.max = 1e-6;
  EXPECT_THAT(TextOf(study), Not(AnyOf(HasSubstr("the same at every one"),
                                       HasSubstr("no limit"))));
}

TEST(StudySectionTest, ComparesTimes) {
  EXPECT_THAT(TextOf(MakeStudy()),
              AllOf(HasSubstr("100 iterations of the iterated pseudo-inverse "
                              "take 10.0 ms here, and took 59.0 min"),
                    HasSubstr("354300")));
}

TEST(StudySectionTest, FiguresSayWhatIsPublishedOfThem) {
  const ReportSection section = MakeStudySection(
      MakeStudy(), {{"error_after", "Errors", "<svg/>", "3 mm."}});
  const auto& figure = std::get<ReportFigure>(section.content.back());
  EXPECT_EQ(figure.title, "Figure 2: error after, training poses");
  EXPECT_EQ(figure.note,
            "3 mm. Published, error after: below 2e-13 mm. Here: 2.1e-13 mm "
            "\"here\".");
}

TEST(StudySectionTest, NoLineIsOverAHundredColumns) {
  std::istringstream lines(FormatSection(MakeStudySection(RunStudy(), {})));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST(StudyJsonTest, HasEveryNumberToTheLastBit) {
  StudyResult study = MakeStudy();
  study.timed_s = 1.0 / 3.0;
  const auto json = nlohmann::json::parse(FormatStudyJson(study));
  EXPECT_EQ(json["source"], "A study of <an> arm");
  EXPECT_EQ(json["rows"][0]["obtained"], "2.1e-13 mm \"here\"");
  EXPECT_EQ(json["parameters"][1]["name"], "d4");
  EXPECT_EQ(json["parameters"][1]["unit"], "m");
  EXPECT_EQ(json["parameters"][1]["obtained"], 1.004e-4);
  EXPECT_EQ(json["parameters"][2]["identified"], false);
  EXPECT_EQ(json["absorptions"][0]["fixed_deviation"], 1e-4);
  EXPECT_EQ(json["absorptions"][0]["coefficient"], 0.004);
  EXPECT_EQ(json["absorptions"][0]["amount"], 4e-7);
  EXPECT_EQ(json["as_printed"]["n"], 20);
  EXPECT_EQ(json["timed_s"], 1.0 / 3.0);
  EXPECT_EQ(json["published_s"], 3543.0);
}

TEST(FormatTest, NumbersAreThoseOfTheReport) {
  EXPECT_EQ(Fixed(-0.0004, 3), "0.000");
  EXPECT_EQ(Fixed(-1.5, 2), "-1.50");
  EXPECT_EQ(Significant(9.9996, 4), "10.00");
  EXPECT_EQ(Significant(0.0, 4), "0");
  EXPECT_EQ(Significant(4e-4, 5), "4.0000e-04");
  EXPECT_EQ(Significant(0.004, 4), "0.004000");
  EXPECT_EQ(Duration(3543.198), "59.1 min");
  EXPECT_EQ(Duration(2.5e-5), "25.0 us");
}

class StudyProgramTest : public ::testing::Test {
 protected:
  static ProcessResult Run(const std::string& arguments) {
    return RunProcess(std::string(ALIDADE_RV2AJ_STUDY) + " " + arguments);
  }
  // The study's job with a change.
  std::string Changed(const std::string& lines) const {
    const std::string path = directory_ / "job.yaml";
    WriteWhole(path,
               "format: alidade-job-1\nextends: " + kJob + "\n" + lines + "\n");
    return path;
  }

  TemporaryDirectory directory_;
};

TEST_F(StudyProgramTest, EndsOnPublishedAgainstObtainedAndThePaths) {
  const std::string out = directory_ / "results";
  const ProcessResult result = Run(kJob + " --out=" + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("4.0000e-04 to 4.0000e-04 mm"),
                                HasSubstr("17 of 25"), HasSubstr("0.100400")));
  EXPECT_GT(result.out.find("result.json"), result.out.find("17 of 25"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("warning"), HasSubstr("beta4")));
  for (const char* name : {"arm.yaml", "report.html", "report.txt",
                           "result.json", "study.json", "validation.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
    EXPECT_THAT(result.out, HasSubstr(out + "/" + name));
  }
  EXPECT_THAT(ReadWhole(out + "/report.txt"),
              AllOf(HasSubstr("\nPublished study\n-"), HasSubstr("17 of 25")));
}

TEST_F(StudyProgramTest, ExitStatusIsThatOfCalibrate) {
  const std::string out = " --out=" + (directory_ / "results");
  EXPECT_EQ(Run("").status, 2);
  EXPECT_EQ(Run(kJob + " --wings=2").status, 2);
  EXPECT_EQ(Run("no_such_file.yaml").status, 2);
  const ProcessResult unpublished = Run(Changed("published: ~") + out);
  EXPECT_EQ(unpublished.status, 2);
  EXPECT_THAT(unpublished.err, HasSubstr("expected `published`"));
  EXPECT_THAT(unpublished.out, IsEmpty());
  const ProcessResult failed =
      Run(Changed("compare_with: ~\nsolver: {name: pseudo_inverse, "
                  "pseudo_inverse_tolerance: 1e-18}") +
          out);
  EXPECT_EQ(failed.status, 3);
  EXPECT_THAT(failed.err, HasSubstr("job.yaml: the solver pseudo_inverse"));
  const ProcessResult missed =
      Run(Changed("acceptance: {train_max: 1e-16}") + out);
  EXPECT_EQ(missed.status, 1) << missed.err;
  EXPECT_THAT(missed.err, HasSubstr("/report.txt says which"));
  EXPECT_THAT(missed.out, HasSubstr("17 of 25"));
}

}  // namespace
}  // namespace alidade::rv2aj
