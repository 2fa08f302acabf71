#include "src/dataio/robot_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace alidade::internal {
namespace {

using ::testing::ElementsAre;

// The lines that move to each position of a program, in the text's order.
std::vector<std::vector<int>> UsesIn(const std::string& path,
                                     const std::string& text) {
  const RobotProgram program = ParseProgram(text, path, 6, {});
  EXPECT_TRUE(program.refused.empty());
  std::vector<std::vector<int>> uses;
  for (const ProgramTarget& target : program.targets) {
    uses.push_back(target.uses);
  }
  return uses;
}

// The order of a program's motions follows from these lines.
TEST(RobotProgramTest, APositionIsUsedUntilItsVariableIsGivenAnother) {
  EXPECT_THAT(UsesIn("a.script",
                     "set_tcp(p[0,0,0.1,0,0,0])\n"
                     "corner = p[0.4,0.2,0.5,0,3.1,0]\n"
                     "movej([0,-1,1,0,1,0])\n"
                     "movel(corner)\n"
                     "corner = p[0.5,0.2,0.5,0,3.1,0]\n"
                     "movel(corner)\n"
                     "movel(corner, a=1.2)\n"),
              ElementsAre(ElementsAre(4), ElementsAre(3), ElementsAre(6, 7)));
  EXPECT_THAT(UsesIn("a.src",
                     "DEF a()\n"
                     "DECL AXIS XP1\n"
                     "XP1={A1 0,A2 10,A3 5,A4 0,A5 30,A6 0}\n"
                     "PTP XP1\n"
                     "PTP XP1 C_PTP\n"
                     "XP1={A1 9,A2 10,A3 5,A4 0,A5 30,A6 0}\n"
                     "PTP XP1\n"
                     "END\n"),
              ElementsAre(ElementsAre(4, 5), ElementsAre(7)));
}

TEST(RobotProgramTest, APositionWithinAMotionIsUsedOnItsOwnLine) {
  EXPECT_THAT(UsesIn("a.script",
                     "movej([0,-1,1,0,1,0])\n"
                     "movel(p[0.4,0.2,0.5,0,3.1,0])\n"),
              ElementsAre(ElementsAre(1), ElementsAre(2)));
}

// So is one that another file moves to.
TEST(RobotProgramTest, APositionThatNothingMovesToIsUsedOnItsOwnLine) {
  EXPECT_THAT(UsesIn("a.dat",
                     "DEFDAT A\n"
                     "DECL E6AXIS XP1={A1 0,A2 10,A3 5,A4 0,A5 30,A6 0}\n"
                     "DECL E6AXIS XP2={A1 9,A2 10,A3 5,A4 0,A5 30,A6 0}\n"
                     "ENDDAT\n"),
              ElementsAre(ElementsAre(2), ElementsAre(3)));
}

// What the robot does there is not what is corrected.
TEST(RobotProgramTest, MotionsThatAreNotCorrectedAreKnown) {
  const auto kinds = [](const std::string& path, const std::string& text) {
    std::vector<std::pair<int, Uncorrected>> found;
    for (const ProgramNote& note : ParseProgram(text, path, 6, {}).left) {
      found.emplace_back(note.line, note.kind);
    }
    return found;
  };
  using Kind = Uncorrected;
  using ::testing::Pair;
  EXPECT_THAT(kinds("a.script",
                    "a = p[0.4,0.2,0.5,0,3.1,0]\n"
                    "movel(pose_trans(p[0.4,0,0.3,0,3,0], a))\n"
                    "movel(b)\n"),
              ElementsAre(Pair(1, Kind::kNoMotion), Pair(2, Kind::kMotion),
                          Pair(3, Kind::kMotion)));
  EXPECT_THAT(
      kinds("a.src", "LIN_REL {Z 10}\nPTP XP1\n"),
      ElementsAre(Pair(1, Kind::kRelativeMotion), Pair(2, Kind::kMotion)));
  EXPECT_THAT(
      kinds("a.ls",
            "/MN\n 1:J PR[1] 100% FINE ;\n 2:L P[1] 100mm/sec FINE "
            "Offset,PR[2] ;\n 3:  PR[1]=PR[2] ;\n/POS\n/END\n"),
      ElementsAre(Pair(2, Kind::kMotion), Pair(3, Kind::kRelativeMotion),
                  Pair(4, Kind::kNoMotion)));
}

// Whatever a language has to move with, and wherever in a statement it stands.
TEST(RobotProgramTest, EveryMotionToWhatIsNotStatedIsCounted) {
  const auto motions = [](const std::string& path, const std::string& text) {
    std::vector<int> lines;
    for (const ProgramNote& note : ParseProgram(text, path, 6, {}).left) {
      if (note.kind == Uncorrected::kMotion) lines.push_back(note.line);
    }
    return lines;
  };
  EXPECT_THAT(motions("a.src",
                      "XP1={X 1,Y 2,Z 3,A 0,B 0,C 0}\n"
                      "LIN XP1\n"
                      "SPL XP2\n"
                      "CIRC {X 1,Y 2,Z 3,A 0,B 0,C 0},XP9\n"
                      "LIN XP1:XOFF\n"
                      "PTP XP[3] C_PTP\n"
                      "CIRC XP1,{X 1,Y 2,Z 3,A 0,B 0,C 0},CA 90\n"),
              ElementsAre(3, 4, 5, 6));
  EXPECT_THAT(motions("a.mod",
                      "p1:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,"
                      "9E9]];\n"
                      "MoveL p1,v1,fine,tool0;\n"
                      "MoveL Offs(pOther,0,0,1),v1,fine,tool0;\n"
                      "MoveC p1,pOther,v1,fine,tool0;\n"
                      "MoveL\\Conc,pOther,v1,fine,tool0;\n"
                      "IF di1=1 MoveL pOther,v1,fine,tool0;\n"
                      "IF di1=1 MoveL p1,v1,fine,tool0;\n"
                      "SearchL di1,pHit,p1,v1,tool0;\n"
                      "MoveHome;\n"),
              ElementsAre(3, 4, 5, 6, 8));
  EXPECT_THAT(motions("a.script",
                      "a = p[0.4,0.2,0.5,0,3.1,0]\n"
                      "movec(a, b, a=1.2)\n"
                      "optimovel(c)\n"
                      "optimovej(p[0.4,0.2,0.5,0,3.1,0])\n"
                      "movel(pose=a)\n"),
              ElementsAre(2, 3));
  EXPECT_THAT(motions("a.ls",
                      "/MN\n 1:L P[R[5]] 100mm/sec FINE ;\n 2:L P[2] "
                      "100mm/sec FINE VOFFSET,VR[1] ;\n/POS\n/END\n"),
              ElementsAre(2));
}

// Then no position that depends on them is known.
TEST(RobotProgramTest, FramesAndPositionsThatChangeAreRefused) {
  const auto refusals = [](const std::string& path, const std::string& text) {
    const Eigen::Isometry3d none = Eigen::Isometry3d::Identity();
    std::vector<std::string> texts;
    for (const ProgramNote& note :
         ParseProgram(text, path, 6,
                      {{"base 1", none}, {"tool 1", none}, {"wr", none}})
             .refused) {
      texts.push_back(note.text);
    }
    return texts;
  };
  const std::string lin = "LIN {X 1,Y 2,Z 3,A 0,B 0,C 0}\n";
  using ::testing::Contains;
  using ::testing::HasSubstr;
  using ::testing::IsEmpty;
  EXPECT_THAT(refusals("a.src", "$BASE=BASE_DATA[1]\n" + lin), IsEmpty());
  for (const char* frame :
       {"$BASE=BASE_DATA[1]:{X 0,Y 0,Z 3,A 0,B 0,C 0}\n",
        "$BASE=$NULLFRAME:XOFF\n", "$BASE=$WORLD\n$BASE.X=100\n"}) {
    EXPECT_THAT(refusals("a.src", frame + lin),
                Contains(HasSubstr("set at run time")))
        << frame;
  }
  const std::string data = "BASE_DATA[1]={X 0,Y 0,Z 3,A 0,B 0,C 0}\n";
  EXPECT_THAT(refusals("a.src", data + data), IsEmpty());
  EXPECT_THAT(
      refusals("a.src", data + "BASE_DATA[1]={X 0,Y 0,Z 0,A 0,B 0,C 0}\n"),
      Contains(HasSubstr("base 1 is stated once more")));
  EXPECT_THAT(refusals("a.src", data + "BASE_DATA[1].Z=9\n"),
              Contains("base 1 is changed in parts"));
  EXPECT_THAT(refusals("a.src",
                       "XP4={X 1,Y 2,Z 3,A 0,B 0,C 0}\nXP4=$POS_ACT\n"
                       "LIN XP4\n"),
              Contains(HasSubstr("XP4 is moved to and also computed with")));
  const std::string point =
      "p1:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n";
  const std::string move = "MoveL p1,v1,fine,tool0\\WObj:=wR;\n";
  const std::string frames = "[[0,0,3],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n";
  const auto object = [&](const char* head) {
    return "wobjdata wR:=[" + std::string(head) + "," + frames + point + move;
  };
  EXPECT_THAT(refusals("a.mod", object("FALSE,TRUE,\"\"")), IsEmpty());
  EXPECT_THAT(refusals("a.mod", object("TRUE,TRUE,\"\"")),
              Contains("its wr is held by the robot"));
  EXPECT_THAT(refusals("a.mod", object("FALSE,FALSE,\"STN1\"")),
              Contains("its wr is moved by a mechanical unit"));
  EXPECT_THAT(refusals("a.mod", object("FALSE,TRUE,\"\"") +
                                    "wR.oframe.trans:=[1,2,3];\n"),
              Contains("wr is changed at run time"));
  EXPECT_THAT(refusals("a.mod", point + "p1:=CRobT();\n" + move),
              Contains("P1 is moved to and also set at run time"));
}

TEST(RobotProgramTest, StraightMotionsAreKnown) {
  const auto straight = [](const std::string& path, const std::string& text) {
    return ParseProgram(text, path, 6, {}).straight;
  };
  EXPECT_THAT(straight("a.script",
                       "movej([0,-1,1,0,1,0])\nmovel(p[0.4,0.2,0.5,0,3.1,"
                       "0])\n"),
              ElementsAre(2));
  EXPECT_THAT(straight("a.src", "SPTP XP1\nSLIN XP1\nCIRC XP1,XP2\n"),
              ElementsAre(2, 3));
  EXPECT_THAT(straight("a.mod", "MoveJ p,v1,z1,t;\nMoveLDO p,v1,z1,t,d,1;\n"),
              ElementsAre(2));
  EXPECT_THAT(straight("a.ls",
                       "/MN\n 1:J P[1] 100% FINE ;\n 2:L P[1] 100mm/sec "
                       "FINE ;\n/POS\n/END\n"),
              ElementsAre(3));
}

TEST(RobotProgramTest, DeclarationsAndMotionsAreOneProgram) {
  const std::string declared =
      "DEFDAT A\nDECL E6POS XP1={X 1,Y 2,Z 3,A 0,B 0,C 0,S 2,T 0}\nENDDAT";
  const std::string moves = "DEF a()\nBAS(#TOOL,1)\nBAS(#BASE,2)\nLIN XP1\n";
  const RobotProgram missing =
      ParseProgram(moves, "a.src", 6, {}, {{"cell/a.dat", declared}});
  EXPECT_THAT(missing.missing,
              ElementsAre(::testing::Pair("base 2", ElementsAre(2)),
                          ::testing::Pair("tool 1", ElementsAre(2))));
  const Eigen::Isometry3d none = Eigen::Isometry3d::Identity();
  const RobotProgram program =
      ParseProgram(moves, "a.src", 6, {{"tool 1", none}, {"base 2", none}},
                   {{"cell/a.dat", declared}});
  ASSERT_EQ(program.targets.size(), 1U);
  EXPECT_EQ(program.targets[0].tool, "tool 1");
  EXPECT_EQ(LineName(program, program.targets[0].line), "a.dat line 2");
  EXPECT_EQ(LineName(program, program.targets[0].uses[0]), "line 4");
  EXPECT_EQ(PlaceOf(program, 2), std::make_pair(std::string("cell/a.dat"), 2));
  ProgramValues values;
  values.numbers = {1.5, 2.0, 3.0, 0.0, 0.0, 0.0};
  EXPECT_THAT(RewriteProgram(program, {values}),
              ElementsAre("DEFDAT A\nDECL E6POS XP1={X 1.500,Y 2.000,Z 3.000,A "
                          "0.0000,B 0.0000,C 0.0000,S 2,T 0}\nENDDAT",
                          moves));
}

// What stands before ":=" may be anything where brackets are missing.
TEST(RobotProgramTest, WhatIsNoNameIsNoVariable) {
  const RobotProgram program = ParseProgram(
      "MODULE a\n"
      "[0,0,0,0,30,0],[9E9]]here:=[[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
      "MoveAbsJ here,v100,fine,tool0;\n"
      "ENDMODULE\n",
      "a.mod", 6, {});
  EXPECT_TRUE(program.targets.empty());
  ASSERT_EQ(program.left.size(), 2U);
  EXPECT_EQ(program.left[0].line, 2);
  EXPECT_EQ(program.left[0].text, "is given to no variable");
}

TEST(RobotProgramTest, APositionThatNoNumberHoldsIsRefused) {
  for (const char* text :
       {"movel(p[0.4,0.2,0.5,0,3,1e308])\n",
        "set_tcp(p[0,0,0.1,0,3,1e308]) movel(p[0.4,0.2,0.5,0,3,0])\n"}) {
    const RobotProgram program = ParseProgram(text, "a.script", 6, {});
    EXPECT_TRUE(program.targets.empty()) << text;
    ASSERT_EQ(program.refused.size(), 1U) << text;
    EXPECT_EQ(program.refused[0].line, 1);
    EXPECT_EQ(program.refused[0].text,
              "a position, tool or base of numbers that are too large");
  }
}

TEST(RobotProgramTest, RoutinesThatMoveBreakTheOrderOfTheText) {
  const auto breaks = [](const std::string& path, const std::string& text) {
    std::vector<std::string> found;
    for (const ProgramNote& note : ParseProgram(text, path, 6, {}).breaks) {
      found.push_back(std::to_string(note.line) + " " + note.text);
    }
    return found;
  };
  EXPECT_THAT(breaks("a.script",
                     "def Main():\n"
                     "  def sub():\n"
                     "    if True:\n"
                     "      movel(p[0.4,0.2,0.5,0,3.1,0])\n"
                     "    end\n"
                     "  end\n"
                     "  def grip():\n"
                     "    set_digital_out(1, True)\n"
                     "  end\n"
                     "  movej([0,-1,1,0,1,0])\n"
                     "  grip()\n"
                     "  sub()\n"
                     "end\n"),
              ElementsAre("1 begins def Main", "2 begins def sub",
                          "6 ends def sub", "12 calls def sub"));
  EXPECT_THAT(breaks("a.mod",
                     "MODULE a\n"
                     "  PROC main()\n"
                     "    weld;\n"
                     "  ENDPROC\n"
                     "  LOCAL PROC weld()\n"
                     "    MoveAbsJ [[0,10,5,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]],"
                     "v100,fine,tool0;\n"
                     "  ENDPROC\n"
                     "ENDMODULE\n"),
              ElementsAre("2 begins PROC main", "3 calls PROC weld",
                          "5 begins PROC weld"));
}

}  // namespace
}  // namespace alidade::internal
