// What `alidade import` makes of tables that people have: columns, units, two
// files, rows that have slipped, and what it leaves of earlier work.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace alidade::internal::import_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProcessResult;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

// An arm whose base is nowhere near its origin.
constexpr char kPlaces[] =
    "base: {x: 1650, y: -840, z: 410, rx: 1, ry: -2, rz: 143}\n";

using Row = std::vector<double>;

class ImportTest : public ::testing::Test {
 protected:
  ProcessResult Alidade(const std::string& arguments) const {
    return testing::RunIn(directory_.path(),
                          std::string(ALIDADE_BINARY) + " " + arguments);
  }
  void Write(const std::string& name, const std::string& text) const {
    WriteWhole(directory_ / name, text);
  }
  std::string Read(const std::string& name) const {
    return ReadWhole(directory_ / name);
  }

  // Joint values (deg) and the pose at them: x, y, z (mm), rx, ry, rz (deg).
  std::vector<Row> Poses(int count) const {
    std::string joints = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < 6; ++j) {
        const int value = (i * (17 + 10 * j) + 31 * j) % 160 - 80;
        joints += std::to_string(value) + (j < 5 ? "," : "\n");
      }
    }
    Write("joints.csv", joints);
    Write("placed.yaml", ReadWhole(std::string(ALIDADE_SOURCE_DIR) +
                                   "/configs/robots/irb120.yaml") +
                             kPlaces);
    const ProcessResult poses =
        Alidade("fk placed.yaml joints.csv --rotation=extrinsic_xyz");
    EXPECT_EQ(poses.status, 0) << poses.err;
    std::vector<Row> rows;
    std::istringstream lines(poses.out);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#' || line[0] == 'q') continue;
      std::istringstream cells(line);
      Row row;
      for (std::string cell; std::getline(cells, cell, ',');) {
        row.push_back(std::stod(cell));
      }
      rows.push_back(row);
    }
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(count));
    return rows;
  }

  // `header` and a line of each row's cells.
  static std::string Table(const std::string& header,
                           const std::vector<Row>& rows) {
    std::ostringstream text;
    text.precision(10);
    text << header << "\n";
    for (const Row& row : rows) {
      for (std::size_t i = 0; i < row.size(); ++i) {
        text << row[i] << (i + 1 < row.size() ? "," : "\n");
      }
    }
    return text.str();
  }

  const TemporaryDirectory directory_;
};

std::vector<Row> Times(std::vector<Row> rows, std::size_t first,
                       std::size_t last, double factor) {
  for (Row& row : rows) {
    for (std::size_t i = first; i < last; ++i) row[i] *= factor;
  }
  return rows;
}

constexpr char kPosition[] = "J1,J2,J3,J4,J5,J6,X,Y,Z";

std::vector<Row> PositionsOf(std::vector<Row> rows) {
  for (Row& row : rows) row.resize(9);
  return rows;
}

TEST_F(ImportTest, EachCalibrationHasAFolderOfItsOwn) {
  Write("cell.csv", Table(kPosition, PositionsOf(Poses(40))));
  const ProcessResult imported =
      Alidade("import cell.csv --arm=robots/irb120 --out=results/cell");
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_THAT(imported.out,
              HasSubstr("Next: alidade calibrate results/cell/job.yaml "
                        "--report --out=results/cell/result\n"));
  // Without --out too.
  const ProcessResult done =
      Alidade("calibrate results/cell/job.yaml --report");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_TRUE(
      std::filesystem::exists(directory_ / "results/cell/result/report.html"));
  EXPECT_THAT(done.out, HasSubstr("Next: alidade correct results/cell/result"));
  const ProcessResult again = Alidade("calibrate results/cell/job.yaml");
  EXPECT_THAT(again.out, HasSubstr("result/report.html was that of an earlier "
                                   "run, and is removed"));
}

TEST_F(ImportTest, JobsOfSeveralImportsRunTogether) {
  Write("cell.csv", Table(kPosition, PositionsOf(Poses(30))));
  for (const char* name : {"left", "right"}) {
    const ProcessResult imported =
        Alidade(std::string("import cell.csv --arm=robots/irb120 "
                            "--units=mm,deg --out=results/") +
                name);
    ASSERT_EQ(imported.status, 0) << imported.err;
  }
  const ProcessResult batch =
      Alidade("batch results/left/job.yaml results/right/job.yaml --dry-run");
  EXPECT_EQ(batch.status, 0) << batch.err;
  EXPECT_THAT(batch.out, HasSubstr("left"));
  EXPECT_THAT(batch.out, HasSubstr("right"));
}

TEST_F(ImportTest, AnEditedJobIsKept) {
  Write("cell.csv", Table(kPosition, PositionsOf(Poses(30))));
  const std::string import =
      "import cell.csv --arm=robots/irb120 --units=mm,deg --out=a";
  ASSERT_EQ(Alidade(import).status, 0);
  const std::string job = Read("a/job.yaml");
  EXPECT_THAT(Alidade(import).out, Not(HasSubstr("job.yaml.old")));
  Write("a/job.yaml", job + "robust: {loss: tukey}\n");
  EXPECT_THAT(Alidade(import).out, HasSubstr("kept as a/job.yaml.old"));
  EXPECT_EQ(Read("a/job.yaml"), job);
  EXPECT_EQ(Read("a/job.yaml.old"), job + "robust: {loss: tukey}\n");
  Write("a/job.yaml", job + "robust: {loss: huber}\n");
  EXPECT_THAT(Alidade(import).out, HasSubstr("kept as a/job.yaml.old2"));
  EXPECT_EQ(Read("a/job.yaml.old"), job + "robust: {loss: tukey}\n");
}

constexpr char kPoses[] =
    "nr,base,shoulder,elbow,wrist1,wrist 2,wrist_3,TX,TY,TZ,RotX,RotY,RotZ,"
    "temp";

std::vector<Row> Numbered(std::vector<Row> rows) {
  double number = 0.0;
  for (Row& row : rows) {
    row.insert(row.begin(), ++number);
    row.push_back(20.0 + number);
  }
  return rows;
}

TEST_F(ImportTest, OrientationsHaveUnitsOfTheirOwn) {
  const std::vector<Row> rows = Times(Poses(30), 0, 6, kDegree);
  const std::string import =
      "import ur.csv --arm=robots/irb120 --rotation=extrinsic_xyz --out=ur";
  Write("ur.csv", Table(kPoses, Numbered(rows)));
  const ProcessResult found = Alidade(import);
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, ::testing::ContainsRegex("wrist_3 +joint 6 +rad"));
  EXPECT_THAT(found.out, ::testing::ContainsRegex("RotX +rx +deg"));
  EXPECT_THAT(found.out, HasSubstr("orientation are in degrees"));
  EXPECT_THAT(found.out, HasSubstr("numbers that are passed over: temp;"));
  EXPECT_THAT(found.out, HasSubstr("position: [TX, TY, TZ], unit: [mm, rad], "
                                   "covariates: [temp]}}"));
  const std::string data = Read("ur/data.csv");
  const ProcessResult stated = Alidade(import + " --units=mm,rad,deg");
  ASSERT_EQ(stated.status, 0) << stated.err;
  EXPECT_EQ(Read("ur/data.csv"), data);
  // One unit of angles is that of all.
  const ProcessResult wrong = Alidade(import + " --units=mm,rad");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("are these degrees?"));
  EXPECT_THAT(Alidade(import + " --units=mm,rad,deg,rad").err,
              HasSubstr("a unit too many of its kind"));

  // Within a turn the arm decides.
  Write("ur.csv", Table(kPoses, Numbered(Times(rows, 9, 12, kDegree))));
  const ProcessResult radians = Alidade(import);
  ASSERT_EQ(radians.status, 0) << radians.err;
  EXPECT_THAT(radians.out, ::testing::ContainsRegex("RotX +rx +rad"));
  // Another convention: the arm shows which.
  Write("ur.csv", Table(kPoses, Numbered(rows)));
  for (const char* rotation : {"", " --rotation=intrinsic_xyz"}) {
    EXPECT_THAT(
        Alidade(std::string("import ur.csv --arm=robots/irb120") + rotation)
            .out,
        HasSubstr("they fit the arm as intrinsic_zyx or extrinsic_xyz, to "));
  }
  Write("ur.csv", Table(kPoses, Numbered(Times(rows, 9, 12, kDegree))));
  EXPECT_THAT(Alidade("import ur.csv --arm=robots/irb120 "
                      "--rotation=intrinsic_zxz")
                  .err,
              HasSubstr("RotX_deg"));
}

TEST_F(ImportTest, JobsStateUnitsOfOrientationsToo) {
  Write("ur.csv", Table(kPoses, Numbered(Times(Poses(20), 0, 6, kDegree))));
  const std::string job =
      "format: alidade-job-2\ntitle: a\nunits: {length: mm, angle: rad}\n"
      "arm: robots/irb120\n"
      "data: {file: ur.csv, rotation: extrinsic_xyz, columns: {joints: [base, "
      "shoulder, elbow, wrist1, wrist 2, wrist_3], position: [TX, TY, TZ], "
      "orientation: [RotX, RotY, RotZ]";
  const std::string rest = "}}\nmeasurement: {sigma: 0.03}\n";
  Write("job.yaml", job + rest);
  const ProcessResult refused = Alidade("check job.yaml");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("more than 10 rad: are these degrees?"));
  Write("job.yaml", job + ", unit: [mm, rad, deg]" + rest);
  const ProcessResult read = Alidade("check job.yaml");
  EXPECT_EQ(read.status, 0) << read.err;
}

TEST_F(ImportTest, SeveralTargetsInARowAreThoseOfTheArm) {
  std::vector<Row> rows = PositionsOf(Poses(30));
  for (Row& row : rows) {
    for (int k = 6; k < 9; ++k) row.push_back(row[k] + 10.0);
  }
  Write("faro.csv",
        Table("J1,J2,J3,J4,J5,J6,SMR1 X,SMR1 Y,SMR1 Z,SMR2 X,SMR2 Y,SMR2 Z",
              rows));
  const ProcessResult read =
      Alidade("import faro.csv --arm=robots/irb120_reflectors --out=a");
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, ::testing::ContainsRegex("SMR2 Z +smr2 z +mm"));
  EXPECT_THAT(read.out, HasSubstr("30 poses"));
  EXPECT_THAT(Read("a/data.csv"), HasSubstr(",smr2,line 31\n"));
  EXPECT_EQ(Alidade("check a/job.yaml").status, 0);
  const ProcessResult refused = Alidade("import faro.csv --arm=robots/irb120");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("columns: {joints: [J1, J2, J3, J4, J5, J6], targets: "
                        "{smr1: [SMR1 X, SMR1 Y, SMR1 Z], smr2: [SMR2 X, "
                        "SMR2 Y, SMR2 Z]}}"));
  EXPECT_THAT(refused.err, HasSubstr("robots/irb120_reflectors"));
}

TEST_F(ImportTest, ColumnsOfAlidadesOwnNamesAreSaidToBeUsed) {
  std::string text = "point,J1,J2,J3,J4,J5,J6,X,Y,Z,target\n";
  for (const Row& row : PositionsOf(Poses(30))) {
    text += "P" + std::to_string(text.size());
    for (const double cell : row) text += "," + std::to_string(cell);
    text += ",smr2\n";
  }
  Write("own.csv", text);
  const ProcessResult read =
      Alidade("import own.csv --arm=robots/irb120_reflectors --units=mm,deg");
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, ::testing::ContainsRegex("target +target "));
  // A name of the row is none of a reference.
  EXPECT_THAT(read.out, ::testing::ContainsRegex("point +\\(passed over\\)"));
}

TEST_F(ImportTest, AllShortRowsAreNamed) {
  const std::string text = Table(kPosition, PositionsOf(Poses(30)));
  Write("slipped.csv", text + "1,2,3,4,5,6\n2,3,4,5,6,7\n3,4,5,6,7,8\n");
  const ProcessResult slipped =
      Alidade("import slipped.csv --arm=robots/irb120");
  EXPECT_EQ(slipped.status, 2);
  EXPECT_THAT(slipped.err, HasSubstr("slipped.csv:32: expected 9 cells"));
  EXPECT_THAT(slipped.err, HasSubstr("columns may have slipped"));
  EXPECT_THAT(slipped.err, HasSubstr("--exclude=32-34"));
  EXPECT_EQ(
      Alidade("import slipped.csv --arm=robots/irb120 --exclude=32-34").status,
      0);
  // A spreadsheet fills rows up.
  Write("slipped.csv", text + ",,,,,,7,8,9\n,,,,,,17,18,19\n");
  EXPECT_THAT(Alidade("import slipped.csv --arm=robots/irb120").err,
              HasSubstr("slipped.csv:32: no joint values in lines 32-33, the "
                        "last rows of the table: columns may have slipped"));
  // Or there are two lines of no measurement.
  EXPECT_EQ(Alidade("import slipped.csv --arm=robots/irb120 "
                    "'--exclude=J1 = nothing,X = 7,X = 17'")
                .status,
            0);
  Write("slipped.csv", text + "1,2,3,4,5,6,,,\n2,3,4,5,6,7,,,\n");
  EXPECT_THAT(Alidade("import slipped.csv --arm=robots/irb120").out,
              HasSubstr("the last rows have no positions (lines 32-33)"));
  Write("short.csv",
        Table("J1,J2,J3,J4,J5,J6,X,Y,Z\n1,2,3\n1,2,4", PositionsOf(Poses(30))));
  const ProcessResult few = Alidade("import short.csv --arm=robots/irb120");
  EXPECT_THAT(few.err, HasSubstr("--exclude=2-3 leaves them out"));
  EXPECT_THAT(few.err, Not(HasSubstr("slipped")));
}

// Joint values of a controller, points of an instrument.
class MatchTest : public ImportTest {
 protected:
  void SetUp() override {
    int number = 0;
    for (const Row& row : Poses(30)) {
      const std::string name = "P" + std::to_string(++number);
      joints_ += name;
      for (int k = 0; k < 6; ++k) {
        std::string cell = std::to_string(row[k]);
        cell[cell.find('.')] = ',';
        joints_ += ";" + cell;
      }
      joints_ += "\n";
      if (number == 4) continue;
      points_ = "A::Cell7::" + name + ", " + std::to_string(row[6]) + ", " +
                std::to_string(row[7]) + ", " + std::to_string(row[8]) + "\n" +
                points_;
    }
    Write("joints.csv", "Point;A1;A2;A3;A4;A5;A6\n" + joints_);
    Write("points.txt", Points());
  }
  std::string Points() const {
    return "// Units: Millimeters\n// Target Name, X, Y, Z\n" + points_ +
           "A::Cell7::Home, 1, 2, 3\n";
  }

  std::string joints_;
  std::string points_;
};

TEST_F(MatchTest, TwoFilesArePutTogetherByThePointsNames) {
  const ProcessResult read = Alidade(
      "import joints.csv points.txt --match=Point --arm=robots/irb120 --out=a");
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("29 points are in both files, by \"Point\" "
                                  "and \"Target Name\""));
  EXPECT_THAT(read.out, HasSubstr("in joints.csv alone, and left out: P4\n"));
  EXPECT_THAT(read.out, HasSubstr("in points.txt alone, and left out: Home\n"));
  EXPECT_THAT(read.out, HasSubstr("29 poses"));
  EXPECT_THAT(Read("a/data.csv"), HasSubstr(",Point P5 (line 5)\n"));
  // In either order, by the other's column.
  const std::string data = Read("a/data.csv");
  EXPECT_EQ(Alidade("import points.txt joints.csv '--match=Target Name' "
                    "--arm=robots/irb120 --out=b")
                .status,
            0);
}

TEST_F(MatchTest, WhatIsNotCertainIsRefused) {
  const std::string import =
      "import joints.csv points.txt --arm=robots/irb120 --out=a";
  EXPECT_THAT(Alidade(import).err, HasSubstr("two files, expected one, or "
                                             "--match=COLUMN"));
  EXPECT_THAT(Alidade(import + " --match=Poimt").err,
              HasSubstr("did you mean \"Point\"?"));
  Write("points.txt", Points() + "B::P7, 1, 2, 3\n");
  EXPECT_THAT(Alidade(import + " --match=Point").err,
              HasSubstr("point \"P7\" is in line "));
  Write("points.txt", "Name,X,Y,Z\nQ1,1,2,3.5\nQ2,1,2,4.5\n");
  EXPECT_THAT(Alidade(import + " --match=Point").err,
              HasSubstr("none of its points (Q1 ...) is in joints.csv"));
  EXPECT_THAT(Alidade("import joints.csv --arm=robots/irb120").err,
              HasSubstr("--match=COLUMN"));
  EXPECT_THAT(Alidade("import points.txt --arm=robots/irb120").err,
              HasSubstr("--match=COLUMN"));
  EXPECT_THAT(
      Alidade("import joints.csv --match=Point --arm=robots/irb120").err,
      HasSubstr("puts two files together"));
}

}  // namespace
}  // namespace alidade::internal::import_test
