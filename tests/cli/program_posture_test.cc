// Postures that programs state or leave open, and KRL programs of two files, as
// `alidade correct` takes them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>

#include "alidade/arm_file.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/number_text.h"
#include "src/dataio/robot_program.h"
#include "tests/support/process.h"

namespace alidade::internal::program_posture_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kRobots =
    std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/";

class ProgramPostureTest : public ::testing::Test {
 protected:
  // By the arm itself, so that positions stay where they are.
  testing::ProcessResult Correct(const std::string& file,
                                 const std::string& text,
                                 const std::string& more = "",
                                 const std::string& robot = "kr6_r900_sixx") {
    WriteWhole(directory_ / file, text);
    const std::string arm = kRobots + robot + ".yaml";
    return testing::RunProcess(std::string(ALIDADE_BINARY) + " correct " + arm +
                               " " + (directory_ / file) + " --nominal=" + arm +
                               " --out=" + (directory_ / ("out/" + file)) +
                               " " + more);
  }

  // {X 1,...} of the pose at joint values in deg, with more behind it.
  static std::string Pose(const Eigen::VectorXd& degrees,
                          const std::string& more = "") {
    ProgramTarget near;
    near.numbers.resize(6);
    const auto numbers = NumbersOfPose(
        ProgramLanguage::kKrl, near,
        TargetPose(LoadArm(kRobots + "kr6_r900_sixx.yaml"), degrees * kDegree));
    std::string text = "{";
    for (int k = 0; k < 6; ++k) {
      text += std::string(k > 0 ? "," : "") + "XYZABC"[k] + " " +
              FixedNumber(numbers[k], 5);
    }
    return text + more + "}";
  }

  static Eigen::VectorXd Joints(double a1, double a2, double a3, double a4,
                                double a5, double a6) {
    Eigen::VectorXd joints(6);
    joints << a1, a2, a3, a4, a5, a6;
    return joints;
  }

  const TemporaryDirectory directory_;
};

TEST_F(ProgramPostureTest, APostureThatNothingStatesIsListed) {
  const std::string first = Pose(Joints(10, -60, 90, 20, 40, 10));
  const std::string second = Pose(Joints(12, -62, 91, 20, 40, 10));
  const auto unknown = Correct("a.src", "DEF a()\nPTP XP7\nLIN " + first +
                                            "\nLIN " + second + "\nEND\n");
  EXPECT_EQ(unknown.status, 0) << unknown.err;
  EXPECT_THAT(
      unknown.out,
      AllOf(HasSubstr("line 3: no posture is known before it (line 2 moves to "
                      "XP7, which is not stated in this file); taken: A1 "),
            Not(HasSubstr("line 4: no posture")),
            HasSubstr("NOT corrected: 1 motion (line 2), whose")));
  const auto nothing = Correct("a.src", "DEF a()\nLIN " + first + "\nEND\n");
  EXPECT_THAT(nothing.out, HasSubstr("line 2: no posture is known before it "
                                     "(nothing that is stated is moved to"));
  const auto known = Correct(
      "a.src", "DEF a()\nPTP {A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10}\nLIN " +
                   second + "\nEND\n");
  EXPECT_THAT(known.out,
              AllOf(Not(HasSubstr("no posture")), Not(HasSubstr("Warnings")),
                    Not(HasSubstr("NOT corrected"))));
}

TEST_F(ProgramPostureTest, AStraightWayToAnotherPostureIsAWarning) {
  const Eigen::VectorXd end = Joints(12, -62, 91, 20, 40, 10);
  const std::string start =
      "DEF a()\nPTP {A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10}\n";
  // A2, A4, A5 and A6 negative: the wrist turned over.
  const auto turned =
      Correct("a.src", start + "LIN " + Pose(end, ",S 2,T 58") + "\nEND\n");
  EXPECT_EQ(turned.status, 0) << turned.err;
  EXPECT_THAT(turned.out,
              HasSubstr("Warnings\n  from line 2 to line 3: the straight way "
                        "arrives in another posture than its end is corrected "
                        "in: A4 20.0 -> -160.0 deg, A5 40.0 -> -40.0 deg, A6 "
                        "10.0 -> -170.0 deg"));
  for (const std::string& motion :
       {"PTP " + Pose(end, ",S 2,T 58"), "LIN " + Pose(end, ",S 2,T 2")}) {
    const auto other = Correct("a.src", start + motion + "\nEND\n");
    EXPECT_THAT(other.out, Not(HasSubstr("Warnings"))) << motion;
  }
}

// As the controller's interpolation does; the search from the position before
// alone finds another posture here.
TEST_F(ProgramPostureTest, AStraightMotionKeepsThePostureThatItArrivesIn) {
  const std::string start =
      "{A1 24.7,A2 -42.5,A3 90.1,A4 66.1,A5 -94.5,A6 -102}";
  const std::string pose =
      "{X 755.8073,Y 128.0528,Z 880.5813,A 80.85096,B 7.10773,C 94.27776}\n";
  const auto correct = [&](const std::string& motion) {
    const auto result =
        Correct("a.src", "DEF a()\nPTP " + start + "\n" + motion + " " + pose +
                             "LIN " + start + "\nEND\n");
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  EXPECT_THAT(correct("LIN"), Not(HasSubstr("Warnings")));
  EXPECT_THAT(correct("PTP"), HasSubstr("from line 3 to line 4: "));
  // A program of nothing but other files' positions is no success.
  const auto none = Correct("a.src", "DEF a()\nPTP XP1\nEND\n");
  EXPECT_THAT(none.out, AllOf(HasSubstr("Nothing is corrected: no position"),
                              HasSubstr("NOT corrected: 1 motion (line 2)"),
                              Not(HasSubstr("All targets are reached"))));
}

TEST_F(ProgramPostureTest, APostureThatIsNotReachedIsNamedWithOthers) {
  const std::string pose = Pose(Joints(10, -60, 90, 20, 40, 10), ",S 2,T 10");
  const auto result = Correct("a.src", "DEF a()\nPTP " + pose + "\nEND\n");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(
      result.err,
      AllOf(HasSubstr("a.src:2: nothing is written, as 1 position cannot be "
                      "corrected:\n  line 2: T 10 states A1 >= 0, A2 < 0, A3 "
                      ">= 0, A4 < 0, A5 >= 0, A6 >= 0, and the nominal arm "
                      "does not reach it so. It does with "),
            HasSubstr("T 2 (A1 10.0, A2 -60.0, A3 90.0, A4 20.0, A5 40.0, A6 "
                      "10.0 deg)"),
            HasSubstr("Assumed\n  line 2: the program sets no base")));
  const auto rapid = Correct(
      "a.mod",
      "MoveJ [[374,0,630],[0.707107,0,0.707107,0],[2,0,0,0],[9E9,9E9,9E9,9E9,"
      "9E9,9E9]],v1,z1,tool0;\n",
      "", "irb120");
  EXPECT_EQ(rapid.status, 2) << rapid.out;
  EXPECT_THAT(rapid.err,
              AllOf(HasSubstr("line 1: cf1, cf4, cf6 = [2,0,0] states axis 1 "
                              "between 180 and 270 deg, axis 4 between 0 and"),
                    HasSubstr(" deg)")));
}

// cf1, cf4 and cf6 leave an elbow open; cfx does not.
TEST_F(ProgramPostureTest, CfxChoosesAmongPostures) {
  Arm arm = LoadArm(kRobots + "irb120.yaml");
  for (Joint& joint : arm.joints) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  WriteWhole(directory_ / "free.yaml", FormatArm(arm, ""));
  // Two postures of one pose, both in the quadrants [0,-1,0].
  const Eigen::VectorXd front = Joints(3.2, 8.1, 38.3, -42.9, 23.7, 69.9);
  ProgramTarget near;
  near.numbers.resize(7);
  near.numbers[3].value = 1.0;
  const auto n = NumbersOfPose(ProgramLanguage::kRapid, near,
                               TargetPose(arm, front * kDegree));
  const auto correct = [&](const std::string& configuration) {
    std::string list = "[[";
    for (int k = 0; k < 7; ++k) {
      list += FixedNumber(n[k], 6) + (k == 2 ? "],[" : k == 6 ? "]," : ",");
    }
    WriteWhole(directory_ / "a.mod",
               "MoveAbsJ [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,z1,"
               "tool0;\nMoveJ " +
                   list + configuration +
                   ",[9E9,9E9,9E9,9E9,9E9,9E9]],v1,z1,tool0;\nMoveL " + list +
                   "[0,-1,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v1,z1,tool0;\n");
    const auto result = testing::RunProcess(
        std::string(ALIDADE_BINARY) + " correct " + (directory_ / "free.yaml") +
        " " + (directory_ / "a.mod") + " --nominal=" +
        (directory_ / "free.yaml") + " --out=" + (directory_ / "b.mod"));
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  EXPECT_THAT(correct("[0,-1,0,0]"),
              AllOf(Not(HasSubstr("cfx")), Not(HasSubstr("Warnings"))));
  // From there to the elbow of the next line.
  EXPECT_THAT(correct("[0,-1,0,2]"),
              AllOf(Not(HasSubstr("cfx")),
                    HasSubstr("from line 2 to line 3: the straight way arrives "
                              "in another posture"),
                    HasSubstr("q3 167.8 -> 38.3 deg")));
  EXPECT_THAT(correct("[0,-1,0,7]"),
              HasSubstr("line 2: cfx 7 states wrist centre behind axis 1 and "
                        "behind the lower arm, axis 5 negative, and there is "
                        "no solution so in the quadrants of cf1, cf4, cf6; "
                        "taken: cfx 0, wrist centre in front of axis 1"));
  EXPECT_THAT(correct("[0,-1,0,9]"),
              HasSubstr("line 2: cfx 9 is not used: of six joints it is 0 to "
                        "7"));
}

TEST_F(ProgramPostureTest, MotionsAndDeclarationsAreOneProgram) {
  const std::string frame = "{A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10,E1 0.0}\r\n";
  const std::string declared =
      "DEFDAT A\r\nDECL E6AXIS XHOME=" + frame +
      "DECL E6POS XP1=" + Pose(Joints(12, -62, 91, 20, 40, 10), ",S 2") +
      "\r\nDECL E6POS XOLD={X 1,Y 2,Z 3,A 0,B 0,C "
      "0}\r\nENDDAT";
  const std::string moves =
      "DEF a()\nBAS(#TOOL,1)\n$BASE=BASE_DATA[2]\nPTP XHOME\nLIN XP1\nLIN "
      "XP9\nEND\n";
  WriteWhole(directory_ / "a.dat", declared);
  // Of all frames at once.
  const auto missing = Correct("a.src", moves);
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(
      missing.err,
      AllOf(HasSubstr("base 2 is not stated in the program (a.dat line 3), "
                      "expected a row `base 2` in the table of --frames\n"),
            HasSubstr("tool 1 is not stated in the program (a.dat line 3)"),
            HasSubstr("a_deg, b_deg, c_deg")));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "out/a.src"));
  // A, B, C as the pendant shows them.
  WriteWhole(directory_ / "frames.csv",
             "name,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\ntool 1,0,0,0,0,0,0\n"
             "base 2,0,0,0,0,0,0\n");
  const auto result =
      Correct("a.src", moves, "--frames=" + (directory_ / "frames.csv"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(
      result.out,
      AllOf(HasSubstr("out/a.src\n"), HasSubstr("out/a.dat\n"),
            HasSubstr("a.dat line 4: XOLD is not moved to in this program"),
            HasSubstr("NOT corrected: 1 motion (line 6)"),
            HasSubstr("line 6: moves to XP9, which is not stated in this"),
            Not(HasSubstr("no posture"))));
  EXPECT_EQ(ReadWhole(directory_ / "out/a.src"), moves);
  const std::string out = ReadWhole(directory_ / "out/a.dat");
  EXPECT_THAT(out,
              AllOf(HasSubstr("XHOME={A1 10.0000,A2 -60.0000,"),
                    HasSubstr("XOLD={X 1,Y 2,Z 3,A 0,B 0,C 0}\r\nENDDAT")));
  // Turned frames are read about z, y and x.
  WriteWhole(directory_ / "turned.csv",
             "name,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\ntool 1,0,0,0,0,0,0\n"
             "base 2,0,0,0,10,20,30\n");
  WriteWhole(directory_ / "angles.csv",
             "name,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\ntool 1,0,0,0,0,0,0\n"
             "base 2,0,0,0,30,20,10\n");
  const auto by_pendant =
      Correct("a.src", moves, "--frames=" + (directory_ / "turned.csv"));
  const std::string turned = ReadWhole(directory_ / "out/a.dat");
  const auto by_convention = Correct(
      "a.src", moves,
      "--rotation=intrinsic_zyx --frames=" + (directory_ / "angles.csv"));
  EXPECT_EQ(by_pendant.out, by_convention.out);
  EXPECT_EQ(ReadWhole(directory_ / "out/a.dat"), turned);
  EXPECT_THAT(
      Correct("a.src", moves, "--frames=" + (directory_ / "angles.csv")).err,
      HasSubstr("expected a_deg, b_deg, c_deg for A, B, C of a KUKA, or "
                "--rotation=intrinsic_zyx"));
  // Declarations alone say that they are.
  const auto alone = Correct("a.dat", declared);
  EXPECT_THAT(alone.out + alone.err,
              HasSubstr("name a.src, which lies beside it, and both are"));
}

TEST_F(ProgramPostureTest, MotionsThatAreNotCorrectedAreCounted) {
  const auto script = Correct(
      "a.script", "movej([0,-1,1,0,1,0])\nmovel(pose_trans(a, b))\nmovel(c)\n",
      "", "ur10");
  EXPECT_EQ(script.status, 0) << script.err;
  EXPECT_THAT(script.out,
              HasSubstr("All targets are reached.\nNOT corrected: 2 motions "
                        "(lines 2 and 3), whose positions"));
  EXPECT_THAT(script.out, HasSubstr("(docs/controllers/universal_robots.md)"));
  const auto rapid = Correct(
      "a.mod",
      "CONST robtarget p:=[[374,0,600],[0.707107,0,0.707107,0],[0,0,0,0],[9E9,"
      "9E9,9E9,9E9,9E9,9E9]];\nMoveJ p,v1,z1,tool0;\nMoveL Offs(p,0,0,80),v1,"
      "z1,tool0;\nMoveL q,v1,z1,tool0;\n",
      "", "irb120");
  EXPECT_EQ(rapid.status, 0) << rapid.err;
  EXPECT_THAT(rapid.out,
              AllOf(HasSubstr("NOT corrected: 1 motion (line 4)"),
                    HasSubstr("1 motion goes by an offset from a position "
                              "(line 3) and has its correction")));
}

TEST_F(ProgramPostureTest, ARelativeMotionLeavesNoPostureThatIsKnown) {
  const auto result =
      Correct("a.src",
              "DEF a()\nPTP {A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10}\n"
              "LIN_REL {X 10}\nLIN " +
                  Pose(Joints(12, -62, 91, 20, 40, 10)) + "\nPTP_REL step\n" +
                  "LIN " + Pose(Joints(10, -60, 90, 20, 40, 10)) + "\nEND\n");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(
      result.out,
      AllOf(HasSubstr("line 4: no posture is known before it (line 3 LIN_REL "),
            HasSubstr("line 6: no posture is known before it (line 5 PTP_REL "),
            HasSubstr("2 motions go by an offset")));
}

TEST_F(ProgramPostureTest, WhatNothingMovesToSetsNoPosture) {
  const Eigen::VectorXd joints = Joints(10, -60, 90, 20, 40, 10);
  WriteWhole(directory_ / "a.dat",
             "DEFDAT a\nDECL E6POS XP1=" + Pose(joints, ",S 2,T 2") +
                 "\nDECL FDAT FP1={TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}\n"
                 "ENDDAT\n");
  const auto result =
      Correct("a.src", "DEF a()\nLIN " + Pose(joints) + "\nEND\n");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("line 2: no posture is known before it "
                                    "(nothing that is stated is moved to"));
}

TEST_F(ProgramPostureTest, PointDataThatNothingActivatesMustAgree) {
  const std::string pose = Pose(Joints(10, -60, 90, 20, 40, 10), ",S 2,T 2");
  WriteWhole(directory_ / "a.dat",
             "DEFDAT a\nDECL E6POS XP1=" + pose +
                 "\nDECL FDAT FP1={TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}\n"
                 "ENDDAT\n");
  const std::string tool = "DEF a()\n$TOOL={X 0,Y 0,Z 10,A 0,B 0,C 0}\n";
  EXPECT_THAT(Correct("a.src", tool + "LIN XP1\nEND\n").err,
              HasSubstr("a.dat line 2: XP1: a motion to it has another tool or "
                        "base than FP1 states"));
  EXPECT_EQ(Correct("a.src", tool + "FDAT_ACT=FP1\nLIN XP1\nEND\n").status, 0);
  EXPECT_EQ(
      Correct("a.src", "DEF a()\n$TOOL=$NULLFRAME\nLIN XP1\nEND\n").status, 0);
}

// The text of a program is not the order of its motions.
TEST_F(ProgramPostureTest, ARoutineBeginsInNoPostureThatIsKnown) {
  const Eigen::VectorXd end = Joints(12, -62, 91, 20, 40, 10);
  const std::string start =
      "DEF a()\n$TOOL=$NULLFRAME\n$BASE=$NULLFRAME\n"
      "PTP {A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10}\n";
  const auto result =
      Correct("a.src", start + "b()\nLIN " + Pose(end) +
                           "\nEND\nDEF b()\nLIN " + Pose(end) + "\nEND\n");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(
      result.out,
      AllOf(HasSubstr("line 6: no posture is known before it (line 5 calls "
                      "DEF b)"),
            HasSubstr("line 9: no posture is known before it (line 8 begins "
                      "DEF b)"),
            HasSubstr("line 9: DEF b sets no tool before it; taken: that of "
                      "line 2, in DEF a, the last above it in the text"),
            HasSubstr("line 9: DEF b sets no base before it; taken: that of "
                      "line 3, in DEF a")));
  // No way leads from one to the other; without motions it changes nothing.
  const std::string turned = "LIN " + Pose(end, ",S 2,T 58") + "\nEND\n";
  EXPECT_THAT(Correct("a.src", start + "END\nDEF b()\n" + turned).out,
              Not(HasSubstr("Warnings")));
  EXPECT_THAT(Correct("a.src", start + "b()\n" + turned + "DEF b()\nEND\n").out,
              HasSubstr("Warnings"));
}

TEST_F(ProgramPostureTest, AHomeAtASingularPoseStaysAsItIs) {
  const std::string home = "PTP {A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0}\n";
  const auto result =
      Correct("a.src", "DEF a()\n" + home +
                           "PTP {A1 10,A2 -60,A3 90,A4 20,A5 40,A6 10}\nEND\n");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("Not touched\n  line 2: a joint position at a singular "
                        "pose, left as it is\n"));
  const std::string written = ReadWhole(directory_ / "out/a.src");
  EXPECT_THAT(Correct("b.src", "DEF b()\n" + home + "END\n").out,
              AllOf(HasSubstr("Nothing is corrected: no position"),
                    Not(HasSubstr("What to expect"))));
  EXPECT_EQ(written,
            "DEF a()\n" + home +
                "PTP {A1 10.0000,A2 -60.0000,A3 90.0000,A4 20.0000,A5 40.0000,"
                "A6 10.0000}\nEND\n");
}

TEST_F(ProgramPostureTest, LongListsAreCut) {
  std::string steps;
  for (int k = 0; k < 25; ++k) steps += "LIN_REL {X 1}\n";
  const auto result = Correct("a.src", "DEF a()\n" + steps + "END\n");
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("  line 21: LIN_REL moves relative to where the "
                              "robot is\n  and 5 more\n"),
                    Not(HasSubstr("  line 22: "))));
}

}  // namespace
}  // namespace alidade::internal::program_posture_test
