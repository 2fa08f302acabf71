#include "alidade/result_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "alidade/calibration.h"
#include "alidade/error.h"
#include "alidade/run_file.h"
#include "tests/support/process.h"
#include "tests/support/rv2aj_arms.h"

namespace alidade::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// A calibration with validation poses, warnings and everything that a result
// may hold of positions.
const CalibrationResult& Result() {
  static const auto* const result = [] {
    const Arm nominal = testing::Rv2ajFlange();
    const Arm real = testing::WithRv2ajDeviations(nominal);
    CalibrationOptions options;
    options.holdout = HoldOutOptions();
    options.uncertainty.map_configurations = 50;
    options.acceptance.train_max = 1e-3;
    return new CalibrationResult(Calibrate(
        nominal,
        SimulatePositions(real, DrawConfigurations(real, 60, 1), 2e-5, 1),
        options));
  }();
  return *result;
}

TEST(ResultFileTest, TheTextReadsBackToTheSameBits) {
  ASSERT_TRUE(Result().IsUsable()) << Result().message;
  const std::string text = FormatResult(Result());
  const CalibrationResult read = ParseResult(text);
  EXPECT_EQ(FormatResult(read), text);
  ASSERT_EQ(read.parameters.size(), Result().parameters.size());
  for (std::size_t k = 0; k < read.parameters.size(); ++k) {
    EXPECT_EQ(read.parameters[k].name, Result().parameters[k].name);
    EXPECT_EQ(read.parameters[k].value, Result().parameters[k].value);
    // NaN where it is fixed.
    const double std = Result().parameters[k].std;
    EXPECT_TRUE(std::isnan(std) ? std::isnan(read.parameters[k].std)
                                : read.parameters[k].std == std);
  }
  EXPECT_EQ(read.train.after.rms, Result().train.after.rms);
  EXPECT_EQ(read.validation->after.max, Result().validation->after.max);
}

TEST(ResultFileTest, ADirectoryReadsBack) {
  const testing::TemporaryDirectory directory;
  Save(Result(), directory / "r");
  for (const char* name : {"r", "r/", "r/result.json"}) {
    const CalibrationResult read = LoadResult(directory / name);
    EXPECT_EQ(FormatResult(read), FormatResult(Result())) << name;
    EXPECT_EQ(read.status, Result().status);
    EXPECT_TRUE(read.IsUsable());
    // Files state mm with some 17 digits.
    EXPECT_LT(
        (read.train.residual_after.map() - Result().train.residual_after.map())
            .cwiseAbs()
            .maxCoeff(),
        1e-17);
    EXPECT_LT(
        (read.train.joint_values.map() - Result().train.joint_values.map())
            .cwiseAbs()
            .maxCoeff(),
        1e-14);
    EXPECT_EQ(read.arm.joints[3].d, Result().arm.joints[3].d);
  }
}

TEST(ResultFileTest, ReportsSayTheSameAsTheResult) {
  const std::string text = ReportText(Result());
  EXPECT_THAT(text, HasSubstr("rv2aj_flange"));
  EXPECT_THAT(text, HasSubstr("validation poses"));
  const std::string page = ReportPage(Result());
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("</html>"));
  // It loads nothing.
  for (const char* loading : {"src=\"http", "href=\"http", "url(", "@import"}) {
    EXPECT_THAT(page, Not(HasSubstr(loading)));
  }
}

// Whatever a text of results lacks or has too much, it is taken as a whole or
// refused.
TEST(ResultFileTest, BrokenTextsAreRefused) {
  const std::string text = FormatResult(Result());
  for (std::size_t length = 0; length < text.size() - 2;
       length += 1 + text.size() / 150) {
    EXPECT_THROW(ParseResult(text.substr(0, length)), InputError) << length;
  }
  for (const char* broken :
       {"", "null", "[]", "3", "{}", "{\"format\": 3}",
        "{\"format\": \"alidade-result-99\"}", "{\"format\": "}) {
    EXPECT_THROW(ParseResult(broken), InputError) << broken;
  }
  EXPECT_THROW(ParseResult(std::string(100000, '[')), InputError);
  // Of each line that holds a number, a text in its place.
  std::size_t tried = 0;
  for (std::size_t at = text.find(": 0."); at != std::string::npos;
       at = text.find(": 0.", at + 200)) {
    std::string changed = text;
    changed.replace(at + 2, 1, "\"x\"");
    EXPECT_THROW(ParseResult(changed), InputError) << at;
    ++tried;
  }
  EXPECT_GT(tried, 20U);
}

TEST(ResultFileTest, WhatIsNoResultDirectoryIsRefused) {
  const testing::TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "empty");
  testing::WriteWhole(directory / "file.txt", "of somebody");
  for (const char* name : {"no", "empty", "file.txt"}) {
    EXPECT_THROW(LoadResult(directory / name), InputError) << name;
  }
  EXPECT_THROW(LoadResult(""), InputError);
  // A table of other poses.
  Save(Result(), directory / "r");
  const std::string table = testing::ReadWhole(directory / "r/residuals.csv");
  for (const std::string& other : {std::string(), std::string("nothing\n1\n"),
                                   table.substr(0, table.size() / 2),
                                   table + "1e300,2,3\n", "kind," + table}) {
    testing::WriteWhole(directory / "r/residuals.csv", other);
    EXPECT_THROW(LoadResult(directory / "r"), InputError)
        << other.substr(0, 40);
  }
}

TEST(ResultFileTest, PlansAndStudiesHaveTheirFiles) {
  const Arm arm = testing::Rv2ajFlange();
  const Dataset data =
      SimulatePositions(arm, DrawConfigurations(arm, 40, 1), 2e-5, 1);
  MonteCarloOptions study;
  study.trials = 5;
  study.workspace_poses = 10;
  const MonteCarloResult simulated =
      RunMonteCarlo(arm, data, CalibrationOptions(), study);
  EXPECT_THAT(ReportText(simulated), HasSubstr("5"));
  const std::vector<NamedFile> files = FilesOf(simulated);
  std::vector<std::string> names;
  for (const NamedFile& file : files) {
    names.push_back(file.name);
    EXPECT_FALSE(file.content.empty()) << file.name;
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf(
                         {"montecarlo.csv", "trials.csv", "coverage.svg"}));
  const testing::TemporaryDirectory directory;
  const std::vector<std::string> paths = SaveFiles(files, directory / "d/e");
  ASSERT_EQ(paths.size(), files.size());
  for (std::size_t k = 0; k < files.size(); ++k) {
    EXPECT_EQ(testing::ReadWhole(paths[k]), files[k].content);
  }
  testing::WriteWhole(directory / "in_the_way", "");
  EXPECT_THROW(SaveFiles(files, directory / "in_the_way"), InputError);
}

}  // namespace
}  // namespace alidade::internal
