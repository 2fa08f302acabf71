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

}  // namespace
}  // namespace alidade::internal
