// docs/tutorial_tracker.md as it is written: a spreadsheet's export of a
// tracker, three commands, a result that may be used. And what `import` says
// of other files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace alidade::internal::tracker_path_test {
namespace {

using ::testing::HasSubstr;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

constexpr char kNominal[] =
    "format: alidade-arm-1\n"
    "name: six axes\n"
    "units: {length: mm, angle: deg}\n"
    "convention: standard\n"
    "joints:\n"
    "  - {type: revolute, d: 400, a: 25, alpha: -90, limits: [-170, 170]}\n"
    "  - {type: revolute, theta: -90, a: 455, limits: [-190, 45]}\n"
    "  - {type: revolute, a: 35, alpha: -90, limits: [-120, 156]}\n"
    "  - {type: revolute, d: 420, alpha: 90, limits: [-185, 185]}\n"
    "  - {type: revolute, alpha: -90, limits: [-120, 120]}\n"
    "  - {type: revolute, theta: 180, d: 80, alpha: 180, limits: [-350, "
    "350]}\n";
// Where the tracker stands, and the reflector sits, nobody says.
constexpr char kPlaces[] =
    "base: {x: 1650, y: -840, z: 410, rx: 1, ry: -2, rz: 143}\n"
    "tool: {x: 41, y: -17, z: 63}\n";
constexpr char kDeviations[] =
    "format: alidade-deviations-1\n"
    "units: {length: mm, angle: deg}\n"
    "deviations: {theta2: 0.21, theta3: -0.13, theta5: 0.3, d3: 0.6, r4: "
    "-0.4,\n"
    "  alpha2: 0.02, alpha4: -0.03, d2: 0.2}\n";
constexpr char kSimulation[] =
    "format: alidade-simulation-1\n"
    "units: {length: mm, angle: deg}\n"
    "arm: real.yaml\n"
    "deviations: deviations.yaml\n"
    "poses: {random: {count: 80}}\n"
    "noise: {sigma: 0.03}\n"
    "seed: 5\n"
    "output: measured.csv\n";

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

// "1.384,7471" of "1384.74712".
std::string German(const std::string& number) {
  const bool is_negative = number[0] == '-';
  std::string whole =
      number.substr(is_negative, number.find('.') - is_negative);
  std::string rest = number.substr(number.find('.') + 1, 4);
  if (whole.size() > 3) whole.insert(whole.size() - 3, ".");
  return (is_negative ? "-" : "") + whole + "," + rest;
}

class TrackerPathTest : public ::testing::Test {
 protected:
  ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunProcess("cd " + Path("") + " && " + ALIDADE_BINARY +
                               " " + arguments);
  }
  std::string Path(const std::string& name) const {
    return (directory_.path() / name).string();
  }

  void SetUp() override {
    WriteWhole(Path("arm.yaml"), kNominal);
    WriteWhole(Path("real.yaml"), std::string(kNominal) + kPlaces);
    WriteWhole(Path("deviations.yaml"), kDeviations);
    WriteWhole(Path("simulation.yaml"), kSimulation);
    ASSERT_EQ(Alidade("simulate simulation.yaml").status, 0);
    std::istringstream lines(ReadWhole(Path("measured.csv")));
    for (std::string line; std::getline(lines, line);) {
      if (line[0] != '#' && line[0] != 'q') rows_.push_back(Cells(line));
    }
    ASSERT_EQ(rows_.size(), 80u);
  }

  // As a German spreadsheet saves it, with two lost targets.
  std::string Export() const {
    std::string text =
        "Measurement report;cell 4;;;;;;;;;\r\n;;;;;;;;;;\r\n"
        "No;A1;A2;A3;A4;A5;A6;X;Y;Z;Status\r\n"
        ";deg;deg;deg;deg;deg;deg;mm;mm;mm;\r\n";
    int number = 0;
    for (const std::vector<std::string>& row : rows_) {
      ++number;
      const bool is_lost = number == 2 || number == 40;
      text += std::to_string(number);
      for (std::size_t i = 0; i < 9; ++i) {
        const bool is_missing = is_lost && i >= 6;
        text += ";" +
                (is_missing ? number == 2 ? "---" : "0,0000" : German(row[i]));
      }
      text += is_lost ? ";lost\r\n" : ";OK\r\n";
    }
    return text;
  }

  const TemporaryDirectory directory_;
  std::vector<std::vector<std::string>> rows_;
};

TEST_F(TrackerPathTest, ThreeCommandsLeadFromAnExportToAResult) {
  WriteWhole(Path("export.txt"), Export());
  const ProcessResult import =
      Alidade("import export.txt --arm=arm.yaml --out=spring");
  ASSERT_EQ(import.status, 0) << import.err;
  for (const char* text :
       {"A1 [deg]", "joint 6", "cells are separated by semicolons",
        "decimal marks are commas", "the header is line 3",
        "nothing was measured in line 6", "left out: line 44", "78 poses"}) {
    EXPECT_THAT(import.out, HasSubstr(text));
  }
  // The rows 2 and 40 are left out.
  const std::string data = ReadWhole(Path("spring/data.csv"));
  EXPECT_THAT(data, HasSubstr("z_mm,note\n"));
  EXPECT_THAT(data, HasSubstr(",No 1 (line 5)\n"));
  EXPECT_THAT(data, HasSubstr(",No 41 (line 45)\n"));
  EXPECT_THAT(data, ::testing::Not(HasSubstr("No 40")));

  const ProcessResult calibrate =
      Alidade("calibrate spring/job.yaml --report --out=spring/result");
  ASSERT_EQ(calibrate.status, 0) << calibrate.err;
  EXPECT_TRUE(std::filesystem::exists(Path("spring/result/report.html")));
  // "validation poses  after  MEAN  RMS ...", in mm.
  const std::size_t at = calibrate.out.rfind("validation poses     after");
  ASSERT_NE(at, std::string::npos) << calibrate.out;
  std::istringstream row(calibrate.out.substr(at + 26));
  double mean = 0.0;
  row >> mean;
  EXPECT_GT(mean, 0.03);
  EXPECT_LT(mean, 0.1);

  const ProcessResult identify = Alidade("identify spring/job.yaml");
  EXPECT_EQ(identify.status, 0) << identify.err;
  EXPECT_THAT(identify.out, HasSubstr("62 poses"));
}

TEST_F(TrackerPathTest, AFooterIsLeftOutAsTheMessageSays) {
  WriteWhole(Path("foot.txt"), Export() + "Mean;;;;;;;12,5;13,5;14,5;\r\n");
  const ProcessResult refused = Alidade("import foot.txt --arm=arm.yaml");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--exclude=85 of `import`"));
  for (const char* rows : {"85", "85-", "'No = Mean'"}) {
    const ProcessResult imported = Alidade(
        std::string("import foot.txt --arm=arm.yaml --exclude=") + rows);
    ASSERT_EQ(imported.status, 0) << imported.err;
    EXPECT_THAT(imported.out, HasSubstr("78 poses"));
  }
  EXPECT_THAT(Alidade("import foot.txt --arm=arm.yaml --exclude=last").err,
              HasSubstr("\"last\" is neither lines of the file"));
}

// Numbers in place of lost targets: three times the same, of any size; beyond
// all reach; in one column alone.
TEST_F(TrackerPathTest, SentinelsAreLeftOut) {
  std::vector<std::vector<std::string>> rows = rows_;
  for (const auto& [row, text] :
       {std::pair(4, "-9999"), std::pair(8, "999.99"), std::pair(11, "1e30")}) {
    for (int axis = 6; axis < 9; ++axis) rows[row][axis] = text;
  }
  rows[19][8] = "-9999";
  std::string text = "A1,A2,A3,A4,A5,A6,X,Y,Z\n";
  for (const std::vector<std::string>& row : rows) {
    for (int i = 0; i < 9; ++i) text += row[i] + (i < 8 ? "," : "\n");
  }
  WriteWhole(Path("export.csv"), text);
  const ProcessResult imported =
      Alidade("import export.csv --arm=arm.yaml --out=imported");
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_THAT(imported.out, HasSubstr("line 6, 10, 13, 21"));
  EXPECT_THAT(imported.out, HasSubstr("-9999 mm"));
  EXPECT_THAT(imported.out, HasSubstr("76 poses"));
}

TEST_F(TrackerPathTest, UnitsComeFromTheArm) {
  // No header, no units, a counter in front: metres and radians.
  std::string text;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    text += std::to_string(i + 1);
    for (std::size_t k = 0; k < 9; ++k) {
      const double value = std::stod(rows_[i][k]);
      text += " " + std::to_string(k < 6 ? value * 3.14159265358979 / 180.0
                                         : value * 1e-3);
    }
    text += "\n";
  }
  WriteWhole(Path("log.dat"), text);
  const ProcessResult import = Alidade("import log.dat --arm=arm.yaml");
  ASSERT_EQ(import.status, 0) << import.err;
  EXPECT_THAT(import.out, HasSubstr("under which the positions fit"));
  EXPECT_THAT(import.out, HasSubstr("cells are separated by blanks"));
  EXPECT_THAT(ReadWhole(Path("results/log/data.csv")),
              HasSubstr("q1_rad,q2_rad"));
}

TEST_F(TrackerPathTest, WhatIsNotCertainIsRefused) {
  std::string text = "J1,J2,J3,J4,J5,J6,Cmd J1,X,Y,Z,Y\n";
  WriteWhole(Path("twice.csv"), text + "1,2,3,4,5,6,1,7.5,8,9,8\n");
  ProcessResult refused = Alidade("import twice.csv --arm=arm.yaml");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("columns 9 (\"Y\") and 11 (\"Y\") seem to hold the "
                        "same"));
  WriteWhole(Path("few.csv"), "J1,J2,J3,J4,J5,J6,X,Y,Z\n1,2,3,4,5,6,7.5,8,9\n");
  refused = Alidade("import few.csv --arm=arm.yaml");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--units=mm,deg"));
  EXPECT_EQ(Alidade("import few.csv --arm=arm.yaml --units=mm,deg").status, 0);
}

TEST_F(TrackerPathTest, ColumnsThatMayBeOfUseAreNamed) {
  std::string text = "A1;A2;A3;A4;A5;A6;X;Y;Z;A;B;C;Station\n";
  for (std::size_t k = 0; k < 30; ++k) {
    for (std::size_t i = 0; i < 9; ++i) text += rows_[k][i] + ";";
    text += "10;20;30;S1\n";
  }
  WriteWhole(Path("stations.csv"), text);
  const ProcessResult imported =
      Alidade("import stations.csv --arm=arm.yaml --out=named");
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_THAT(imported.out, HasSubstr("rename them rz, ry and rx"));
  EXPECT_THAT(imported.out, HasSubstr("gives each place a base of its own"));
}

// The numbers of the row of a table that begins with `name`.
std::vector<double> RowOf(const std::string& table, const std::string& name) {
  const std::size_t at = table.find("\n" + name + " ");
  if (at == std::string::npos) return {};
  std::istringstream row(table.substr(at + name.size() + 2));
  std::vector<double> numbers;
  for (double number = 0.0; row >> number;) numbers.push_back(number);
  return numbers;
}

TEST_F(TrackerPathTest, ValidationFindsFramesAnewWhereAsked) {
  const ProcessResult stated = Alidade("validate arm.yaml measured.csv");
  ASSERT_EQ(stated.status, 0) << stated.err;
  EXPECT_GT(RowOf(stated.out, "measured.csv").at(1), 500.0);
  const ProcessResult refitted =
      Alidade("validate arm.yaml measured.csv --refit=base,tool");
  ASSERT_EQ(refitted.status, 0) << refitted.err;
  const double mean =
      RowOf(refitted.out, "measured.csv, base, tool refitted").at(1);
  EXPECT_GT(mean, 0.3);
  EXPECT_LT(mean, 5.0);
  EXPECT_THAT(Alidade("validate arm.yaml measured.csv --refit=bsae").err,
              HasSubstr("did you mean \"base\""));

  // A job says what the columns of an export are.
  WriteWhole(Path("export.txt"), Export());
  WriteWhole(Path("check.yaml"),
             "format: alidade-job-2\ntitle: check\n"
             "units: {length: mm, angle: deg}\narm: arm.yaml\n"
             "data: {file: export.txt, columns: {joints: [A1, A2, A3, A4, A5, "
             "A6], position: [X, Y, Z]}, exclude: [44]}\n"
             "measurement: {sigma: 0.03}\n");
  const ProcessResult job =
      Alidade("validate arm.yaml check.yaml --refit=base,tool");
  ASSERT_EQ(job.status, 0) << job.err;
  const std::vector<double> row =
      RowOf(job.out, "check.yaml, base, tool refitted");
  EXPECT_EQ(row.at(0), 78.0);
  EXPECT_NEAR(row.at(1), mean, 0.1 * mean);
}

TEST_F(TrackerPathTest, AnInstrumentThatWasMovedIsNamed) {
  WriteWhole(Path("moved.yaml"),
             std::string(kNominal) +
                 "base: {x: -420, y: 1930, z: 380, rx: 0, ry: 1, rz: -35}\n"
                 "tool: {x: 41, y: -17, z: 63}\n");
  std::string simulation = kSimulation;
  simulation.replace(simulation.find("real.yaml"), 9, "moved.yaml");
  simulation.replace(simulation.find("seed: 5"), 7, "seed: 6");
  simulation.replace(simulation.find("measured.csv"), 12, "later.csv");
  WriteWhole(Path("later.yaml"), simulation);
  ASSERT_EQ(Alidade("simulate later.yaml").status, 0);
  ASSERT_EQ(Alidade("import measured.csv --arm=arm.yaml --out=imported").status,
            0);
  ASSERT_EQ(Alidade("calibrate imported/job.yaml --out=result").status, 0);

  const ProcessResult later = Alidade("validate result later.csv");
  ASSERT_EQ(later.status, 0) << later.err;
  EXPECT_THAT(later.err, HasSubstr("with --refit=base the errors are 0.0"));
  EXPECT_THAT(later.err, HasSubstr("the instrument seems to be elsewhere"));
  const ProcessResult same = Alidade("validate result measured.csv");
  EXPECT_THAT(same.err, ::testing::Not(HasSubstr("elsewhere")));
}

TEST_F(TrackerPathTest, ArmsAreComparedWithFramesAligned) {
  // They differ in base and tool alone.
  const ProcessResult same = Alidade("validate arm.yaml real.yaml");
  ASSERT_EQ(same.status, 0) << same.err;
  EXPECT_GT(RowOf(same.out, "real.yaml").at(1), 500.0);
  EXPECT_LT(RowOf(same.out, "real.yaml, base and tool aligned").at(1), 1e-3);
}

TEST_F(TrackerPathTest, AnArmAloneIsIdentified) {
  const ProcessResult alone = Alidade("identify arm.yaml");
  ASSERT_EQ(alone.status, 0) << alone.err;
  EXPECT_THAT(alone.out, HasSubstr("200 random poses within the joint limits"));
  EXPECT_THAT(alone.out, HasSubstr("of 42 parameters"));
}

}  // namespace
}  // namespace alidade::internal::tracker_path_test
