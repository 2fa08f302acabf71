// `alidade import` of two files that name the same points.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/import_tables.h"

namespace alidade::internal::import_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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

  // Of 30 poses, with decimal points.
  static std::string JointTable(const std::vector<Row>& poses,
                                const std::string& prefix) {
    std::string text = "Point,A1,A2,A3,A4,A5,A6\n";
    for (std::size_t i = 0; i < poses.size(); ++i) {
      text += prefix + std::to_string(i + 1);
      for (int k = 0; k < 6; ++k) text += "," + std::to_string(poses[i][k]);
      text += "\n";
    }
    return text;
  }
  static std::string PositionOf(const Row& pose) {
    return std::to_string(pose[6]) + "," + std::to_string(pose[7]) + "," +
           std::to_string(pose[8]);
  }
  static std::string PointTable(const std::vector<Row>& poses,
                                const std::string& prefix) {
    std::string text = "Name,X,Y,Z\n";
    for (std::size_t i = 0; i < poses.size(); ++i) {
      text += prefix + std::to_string(i + 1) + "," + PositionOf(poses[i]);
      text += "\n";
    }
    return text;
  }
  ProcessResult Import(const std::string& flags = "--match=Point") const {
    return Alidade("import j.csv p.csv --units=mm,deg --arm=robots/irb120 " +
                   flags + " --out=a");
  }

  std::string joints_;
  std::string points_;
};

TEST_F(MatchTest, TwoFilesArePutTogetherByThePointsNames) {
  const ProcessResult read = Alidade(
      "import joints.csv points.txt --match=Point --arm=robots/irb120 --out=a");
  ASSERT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out,
              HasSubstr("- joints.csv: cells are separated by semicolons\n"
                        "- joints.csv: decimal marks are commas\n"));
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

TEST_F(MatchTest, RowsThatAreNotWholeAreRefused) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  const std::string points = PointTable(poses, "P");
  Write("p.csv", points + "Home,1,2\n");
  EXPECT_THAT(Import().err,
              HasSubstr("p.csv:32: expected 4 cells as in the header, found 3; "
                        "--exclude=p.csv:32 leaves the row out"));
  EXPECT_EQ(Import("--match=Point --exclude=p.csv:32").status, 0);
  Write("p.csv", points + "Home,1,2\nMean,1\n");
  EXPECT_THAT(Import().err, HasSubstr("--exclude=p.csv:32-33 leaves them out"));
  Write("p.csv", points + "Home,1,2,3,4\n");
  EXPECT_THAT(Import().err, HasSubstr("p.csv:32: expected 4 cells as in the "
                                      "header, found 5"));
  // Empty cells behind say nothing.
  Write("p.csv", points + "Home,1,2,3,,\n");
  EXPECT_EQ(Import().status, 0);
  Write("p.csv", points + "\"Home,1,2,3\n");
  const ProcessResult open = Import();
  EXPECT_EQ(open.status, 2);
  EXPECT_THAT(open.err, HasSubstr("p.csv:32:1: expected a closing quote"));
}

TEST_F(MatchTest, NamesMayLookAsComments) {
  const std::vector<Row> poses = Poses(30);
  for (const char* prefix : {"#", "%", "//"}) {
    std::string joints = "A1,A2,A3,A4,A5,A6,Point\n";
    std::string points = "X,Y,Z,#\n";
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string name = prefix + std::to_string(i + 1) + "\n";
      for (int k = 0; k < 6; ++k) joints += std::to_string(poses[i][k]) + ",";
      joints += name;
      points += PositionOf(poses[i]) + "," + name;
    }
    Write("j.csv", joints);
    Write("p.csv", points);
    const ProcessResult read = Import();
    EXPECT_EQ(read.status, 0) << read.err;
    EXPECT_THAT(read.out, HasSubstr("30 poses"));
    const ProcessResult swapped = Alidade(
        "import p.csv j.csv '--match=#' --units=mm,deg --arm=robots/irb120 "
        "--out=b");
    EXPECT_EQ(swapped.status, 0) << swapped.err;
    EXPECT_THAT(swapped.out, HasSubstr("30 poses"));
  }
}

TEST_F(MatchTest, AColumnMayBeCalledAsCommentsBegin) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  std::string points = PointTable(poses, "P");
  points.replace(0, 4, "#");
  Write("p.csv", points);
  const ProcessResult read = Import("--match=Point,#");
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("by \"Point\" and \"#\""));
}

TEST_F(MatchTest, TheColumnOfTheOtherFileIsCertain) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, ""));
  std::string counted = "Nr,Name,X,Y,Z\n";
  std::string commented = "Comment,Name,X,Y,Z\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string name = std::to_string(i + 1);
    counted += std::to_string(poses.size() - i) + "," + name + "," +
               PositionOf(poses[i]) + "\n";
    commented += "," + name + "," + PositionOf(poses[i]) + "\n";
  }
  Write("p.csv", counted);
  const ProcessResult unclear = Import();
  EXPECT_EQ(unclear.status, 2);
  EXPECT_THAT(unclear.err,
              HasSubstr("columns \"Nr\" and \"Name\" both hold names of points "
                        "of the other file: expected --match=\"Point,Nr\" or "
                        "--match=\"Point,Name\""));
  const ProcessResult stated = Import("--match=Point,Name");
  EXPECT_EQ(stated.status, 0) << stated.err;
  EXPECT_THAT(stated.out, HasSubstr("by \"Point\" and \"Name\""));
  EXPECT_THAT(Import("--match=Point,Nome").err,
              HasSubstr("p.csv: --match: unknown column \"Nome\""));
  // Nothing is no name, however often it is there.
  Write("p.csv", commented);
  Write("j.csv", JointTable(poses, "") + ",1,2,3,4,5,6\n");
  const ProcessResult read = Import();
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("by \"Point\" and \"Name\""));
  EXPECT_THAT(read.out, HasSubstr("in j.csv without a name in \"Point\", and "
                                  "left out: line 32"));
}

TEST_F(MatchTest, WholeNamesComeFirst) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "A::P"));
  std::string points = PointTable(poses, "A::P");
  std::string others = PointTable(poses, "B::P");
  Write("p.csv", points + others.substr(others.find('\n') + 1));
  const ProcessResult read = Import();
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_THAT(read.out, HasSubstr("30 points are in both files"));
}

TEST_F(MatchTest, AFileWithoutNamesOfColumnsIsRefused) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  const std::string points = PointTable(poses, "P");
  Write("p.csv", points.substr(points.find('\n') + 1));
  const ProcessResult read = Import();
  EXPECT_EQ(read.status, 2);
  EXPECT_THAT(read.err, HasSubstr("p.csv:1: no line names the columns"));
}

TEST_F(MatchTest, ARowOfNothingIsNoHeader) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  for (const char* nothing : {",,", "NaN,nan,---"}) {
    std::string points = "Name,X,Y,Z\n";
    for (std::size_t i = 0; i < poses.size(); ++i) {
      points += "P" + std::to_string(i + 1) + "," +
                (i < 2 ? nothing : PositionOf(poses[i])) + "\n";
    }
    Write("p.csv", points);
    const ProcessResult read = Import();
    EXPECT_EQ(read.status, 0) << read.err;
    EXPECT_THAT(read.out, HasSubstr("28 poses"));
    EXPECT_THAT(read.out, HasSubstr("nothing was measured in line 2, 3\n"));
  }
}

TEST_F(MatchTest, LinesThatAreLeftOutAreThoseOfAFile) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  std::string points = "Name,X,Y,Z,Status\nP3,0,0,0,lost\n";
  for (std::size_t i = poses.size(); i-- > 0;) {
    points +=
        "P" + std::to_string(i + 1) + "," + PositionOf(poses[i]) + ",ok\n";
  }
  Write("p.csv", points);
  EXPECT_THAT(Import("--match=Point --exclude=2").err,
              HasSubstr("\"2\" are lines of one of two files, expected which: "
                        "--exclude=p.csv:2"));
  EXPECT_THAT(Import("--match=Point '--exclude=Stat = lost'").err,
              HasSubstr("--exclude: unknown column \"Stat\""));
  for (const char* exclude : {"p.csv:2", "'Status = lost'"}) {
    const ProcessResult read =
        Import(std::string("--match=Point --exclude=") + exclude);
    EXPECT_EQ(read.status, 0) << read.err;
    EXPECT_THAT(read.out, HasSubstr("30 poses"));
  }
  const ProcessResult one = Import("--match=Point --exclude=p.csv:2,j.csv:5-");
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("3 poses"));
}

TEST_F(MatchTest, AJoinedFileOfSomebodyElseIsKept) {
  const std::vector<Row> poses = Poses(30);
  Write("j.csv", JointTable(poses, "P"));
  Write("p.csv", PointTable(poses, "P"));
  std::filesystem::create_directory(directory_ / "a");
  Write("a/joined.csv", "mine\n");
  Write("a/data.csv", "data\n");
  // One that fails leaves the data as they are.
  EXPECT_EQ(Alidade("import j.csv p.csv --match=Point --arm=robots/ur10e "
                    "--out=a")
                .status,
            2);
  EXPECT_EQ(Read("a/joined.csv.old"), "mine\n");
  EXPECT_EQ(Read("a/data.csv"), "data\n");
  ASSERT_EQ(Import().status, 0);
  const ProcessResult again = Import();
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.out, Not(HasSubstr("is kept as")));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "a/joined.csv.old2"));
}

}  // namespace
}  // namespace alidade::internal::import_test
