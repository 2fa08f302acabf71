// What `alidade import` makes of tables that people have: columns, units, rows
// that have slipped, and what it leaves of earlier work.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/cli/import_tables.h"

namespace alidade::internal::import_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

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
  EXPECT_THAT(found.out,
              HasSubstr("`data: {file: ../ur.csv, columns: {joints: ["));
  EXPECT_THAT(found.out,
              HasSubstr("position: [TX, TY, TZ], orientation: [RotX, RotY, "
                        "RotZ], unit: [mm, rad, deg], covariates: [temp]}, "
                        "rotation: extrinsic_xyz}`"));
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

TEST_F(ImportTest, JobsTakeTheLineForACovariate) {
  std::vector<Row> rows = PositionsOf(Poses(30));
  for (Row& row : rows) row.push_back(20.0);
  rows[3][6] = rows[3][7] = rows[3][8] = 0.0;
  Write("its cell.csv", Table("J1,J2,J3,J4,J5,J6,X,Y,Z,T's mean [C]", rows));
  const ProcessResult read = Alidade(
      "import 'its cell.csv' --units=mm,deg --arm=robots/irb120 "
      "--exclude=7-8,'J1 > 75' '--out=my dir'");
  ASSERT_EQ(read.status, 0) << read.err;
  const std::size_t begin = read.out.find("`data: ") + 1;
  const std::string section =
      read.out.substr(begin, read.out.find('`', begin) - begin);
  EXPECT_THAT(section, HasSubstr("covariates: ['T''s mean [C]']}, exclude: "
                                 "[5, 7-8, 'J1 > 75']}"));
  std::string job = Read("my dir/job.yaml");
  const std::string data = "data: 'data.csv'";
  job.replace(job.find(data), data.size(), section);
  Write("my dir/job.yaml", job);
  const ProcessResult checked = Alidade("check 'my dir/job.yaml'");
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(read.out,
              HasSubstr("Next: alidade calibrate 'my dir/job.yaml' --report "
                        "--out='my dir/result'\n"));
}

TEST_F(ImportTest, ATargetIsLostWithoutTheOthersOfItsRow) {
  std::vector<Row> rows = PositionsOf(Poses(30));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int k = 0; k < 6; ++k) rows[i].push_back(rows[i][6 + k % 3] + 20.0);
    for (std::size_t k = 6; i % 3 == 0 && k < 9; ++k) rows[i][k] = 0.0;
    for (std::size_t k = 9; i % 3 == 1 && k < 12; ++k) rows[i][k] = 0.0;
    for (std::size_t k = 6; i == 29 && k < 15; ++k) rows[i][k] = -9999.0;
  }
  const std::string header =
      "J1,J2,J3,J4,J5,J6,SMR1 X,SMR1 Y,SMR1 Z,SMR2 X,SMR2 Y,SMR2 Z,SMR3 X,"
      "SMR3 Y,SMR3 Z";
  Write("cell.csv", Table(header, rows));
  const std::string import =
      "import cell.csv --units=mm,deg --arm=robots/irb120_reflectors --out=a";
  const ProcessResult read = Alidade(import);
  ASSERT_EQ(read.status, 0) << read.err;
  const std::string how =
      " was lost (-9999 mm, 0 mm in place of a position, or out of reach) and ";
  EXPECT_THAT(read.out,
              HasSubstr("the target" + how + "the row is left out: line 31\n"));
  EXPECT_THAT(read.out, HasSubstr("target smr1" + how +
                                  "its position is left out: line 2, 5, 8"));
  EXPECT_THAT(read.out, HasSubstr("target smr2" + how +
                                  "its position is left out: line 3, 6, 9"));
  EXPECT_THAT(read.out, HasSubstr("29 poses"));
  EXPECT_THAT(Read("a/data.csv"), Not(HasSubstr(",0,0,0,")));
  // Positions of a target that the arm does not have are not passed over.
  for (const char* other : {"SMR4 X,SMR4 Y,SMR4 Z", "X,Y,Z"}) {
    Write("cell.csv",
          Table(header.substr(0, header.find("SMR3")) + other, rows));
    EXPECT_THAT(Alidade(import).err,
                HasSubstr("seems to hold a position of none of the arm's "
                          "targets smr1, smr2, smr3"));
  }
}

TEST_F(ImportTest, ManyLostPositionsAreSaid) {
  std::vector<Row> rows = PositionsOf(Poses(30));
  for (std::size_t i = 0; i < 20; ++i) rows[i][6] = rows[i][7] = rows[i][8] = 0;
  Write("cell.csv", Table(kPosition, rows));
  const ProcessResult read =
      Alidade("import cell.csv --units=mm,deg --arm=robots/irb120 --out=a");
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("more than half of the positions look as "
                                  "where the target was lost (0 mm"));
}

TEST_F(ImportTest, LostRowsSayNothingOfTheUnitOfOrientations) {
  std::vector<Row> rows = Times(Poses(30), 9, 12, kDegree);
  rows.push_back(
      {10, 20, 30, 40, 50, 60, -9999, -9999, -9999, -9999, -9999, -9999});
  Write("cell.csv", Table("J1,J2,J3,J4,J5,J6,X,Y,Z,Rx,Ry,Rz", rows));
  const ProcessResult read = Alidade(
      "import cell.csv --arm=robots/irb120 --rotation=extrinsic_xyz "
      "--out=a");
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("angles of the orientation are in radians"));
  EXPECT_THAT(read.out, HasSubstr("30 poses"));
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

}  // namespace
}  // namespace alidade::internal::import_test
