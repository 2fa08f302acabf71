// Data that are there twice, and validation that is none.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "tests/support/process.h"

namespace alidade::internal::same_data_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
const std::string kArm = kSource + "/configs/robots/rv2aj_wrist.yaml";

constexpr char kTwice[] = "is a file there twice";
constexpr char kNoValidation[] = "those that the fit has used";

// Two simulated data sets of 40 poses, other in poses and noise.
class SameDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* seed : {"1", "2"}) {
      const std::string name = directory_ / (std::string("sim") + seed);
      WriteWhole(name + ".yaml",
                 "format: alidade-simulation-1\n"
                 "units: {length: mm, angle: deg}\narm: " +
                     kArm +
                     "\nposes: {random: {count: 40}}\nnoise: {sigma: 0.02}\n"
                     "seed: " +
                     seed + "\noutput: data" + seed + ".csv\n");
      ASSERT_EQ(Alidade("simulate " + name + ".yaml").status, 0);
    }
  }

  ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }

  ProcessResult Calibrate(const std::string& data,
                          const std::string& validation = "") const {
    WriteWhole(
        directory_ / "job.yaml",
        "format: alidade-job-1\ntitle: Arm\n"
        "units: {length: mm, angle: deg}\narm: " +
            kArm + "\nmeasurement: {sigma: 0.02}\ndata: " + data + "\n" +
            (validation.empty() ? ""
                                : "validation: {data: " + validation + "}\n"));
    return Alidade("calibrate job.yaml --out=res --report");
  }

  // Its comments, its header and the first `count` of its rows.
  void WritePart(const std::string& from, int count, const std::string& to) {
    std::istringstream lines(ReadWhole(directory_ / from));
    std::string text;
    int rows = -1;
    for (std::string line; rows < count && std::getline(lines, line);) {
      if (line[0] != '#') ++rows;
      text += line + "\n";
    }
    WriteWhole(directory_ / to, text);
  }

  TemporaryDirectory directory_;
};

TEST_F(SameDataTest, OtherDataAreNotDoubted) {
  const ProcessResult result = Calibrate("data1.csv", "data2.csv");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(Not(HasSubstr(kTwice)), Not(HasSubstr(kNoValidation))));
  const ProcessResult validated = Alidade("validate res data2.csv");
  EXPECT_EQ(validated.status, 0);
  EXPECT_THAT(validated.err, Not(HasSubstr("fitted to")));
}

TEST_F(SameDataTest, ValidationByTheFittedDataIsAWarning) {
  for (const char* validation : {"data1.csv", "[data2.csv, data1.csv]"}) {
    const ProcessResult result = Calibrate("data1.csv", validation);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr(std::string(kNoValidation)));
  }
  WritePart("data1.csv", 7, "part.csv");
  const ProcessResult result = Calibrate("data1.csv", "part.csv");
  EXPECT_THAT(result.err, HasSubstr("7 of 7 validation measurements"));
  for (const char* file : {"report.txt", "result.json", "report.html"}) {
    EXPECT_THAT(ReadWhole(directory_ / (std::string("res/") + file)),
                HasSubstr("validation measurements"))
        << file;
  }
  const ProcessResult validated = Alidade("validate res data1.csv");
  EXPECT_EQ(validated.status, 0);
  EXPECT_THAT(validated.err,
              HasSubstr("data1.csv is what the result was fitted to"));
}

TEST_F(SameDataTest, AFileTwiceIsAnErrorAndACopyAWarning) {
  const ProcessResult twice = Calibrate("[data1.csv, data1.csv]");
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.err, AllOf(HasSubstr("job.yaml:6:"),
                               HasSubstr("data1.csv is named twice")));
  EXPECT_EQ(Calibrate("['data*.csv', data1.csv]").status, 2);
  WritePart("data1.csv", 40, "copy.csv");
  const ProcessResult copy = Calibrate("[data1.csv, data2.csv, copy.csv]");
  EXPECT_EQ(copy.status, 0);
  EXPECT_THAT(copy.err, AllOf(HasSubstr("40 of 120 measurements are in"),
                              HasSubstr(kTwice)));
}

}  // namespace
}  // namespace alidade::internal::same_data_test
