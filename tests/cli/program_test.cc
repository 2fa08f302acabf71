// `alidade correct` on robot programs of four languages: positions are
// corrected in place, every other byte stays, --inverse restores them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/cli/program_languages.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"

namespace alidade::internal::program_test {
namespace {

using testing::Fanuc;
using testing::Frame;
using ::testing::HasSubstr;
using testing::Krl;
using testing::KrlSource;
using testing::Language;
using testing::LastDigitsIn;
using testing::Number;
using testing::NumbersIn;
using testing::Position;
using testing::Program;
using testing::Rapid;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::UrScript;
using testing::WriteWhole;

const std::string kSource = ALIDADE_SOURCE_DIR;
constexpr int kPrograms = 20;

class ProgramTest : public ::testing::TestWithParam<const Language& (*)()> {
 protected:
  const Language& language() const { return GetParam()(); }

  void SetUp() override {
    nominal_path_ = kSource + "/configs/robots/" + language().robot + ".yaml";
    nominal_ = LoadArm(nominal_path_);
    Random random(901);
    real_ = testing::WithRandomErrors(nominal_, &random);
    WriteWhole(directory_ / "real.yaml", FormatArm(real_, ""));
    std::string frames = "name,x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg\n";
    for (const auto& [name, frame] :
         {std::pair<std::string, Eigen::Isometry3d>{
              "tool 1", Frame(0.02, -0.01, 0.12, 0.3)},
          {"base 2", Frame(0.1, 0.2, 0.05, -0.2)}}) {
      const Eigen::Matrix3d rotation = frame.linear();
      const Eigen::Vector3d w = VectorFromRotation(rotation) / kDegree;
      frames += name;
      for (const double x : frame.translation()) {
        frames += "," + Number(x * 1e3, 12);
      }
      for (const double x : w) frames += "," + Number(x, 12);
      frames += "\n";
    }
    WriteWhole(directory_ / "frames.csv", frames);
  }

  testing::ProcessResult Correct(const std::string& in, const std::string& out,
                                 const std::string& more = "") {
    return testing::RunProcess(
        std::string(ALIDADE_BINARY) + " correct " + (directory_ / "real.yaml") +
        " " + in + " --nominal=" + nominal_path_ + " --out=" + out +
        " --frames=" + (directory_ / "frames.csv") + " " + more);
  }

  std::string TextOf(const Program& program) const {
    std::string text;
    for (std::size_t k = 0; k < program.positions.size(); ++k) {
      text += program.pieces[k] + language().write(program.positions[k]);
    }
    return text + program.pieces.back();
  }

  // What stands between the pieces, which must all be there.
  std::vector<std::string> Between(const Program& program,
                                   const std::string& text) const {
    std::vector<std::string> found;
    std::size_t at = 0;
    for (std::size_t k = 0; k < program.pieces.size(); ++k) {
      const std::string& piece = program.pieces[k];
      const std::size_t next = k + 1 == program.pieces.size()
                                   ? text.size() - piece.size()
                                   : text.find(piece, at);
      EXPECT_NE(next, std::string::npos) << piece;
      EXPECT_EQ(text.substr(next, piece.size()), piece);
      if (k > 0) found.push_back(text.substr(at, next - at));
      at = next + piece.size();
    }
    return found;
  }

  // Where the real arm brings the tool when the controller, which believes in
  // the nominal arm, is given the numbers.
  Eigen::Isometry3d Reached(const Position& position,
                            const std::vector<double>& numbers) const {
    Eigen::VectorXd joints(6);
    if (position.is_joints) {
      for (int j = 0; j < 6; ++j) joints[j] = numbers[j] * language().angle;
    } else {
      const Eigen::Isometry3d flange =
          position.frame * language().read(numbers) * position.tool.inverse();
      const PoseSolutions found =
          SolvePoses(nominal_, {flange}, position.joints);
      EXPECT_EQ(found.status[0], PoseStatus::kReached);
      joints = found.joint_values.col(0);
    }
    Eigen::Isometry3d pose;
    pose.matrix() =
        testing::ErrorTermKinematics(real_).TargetFrame(joints).cast<double>();
    return position.frame.inverse() * pose * position.tool;
  }

  const TemporaryDirectory directory_;
  std::string nominal_path_;
  Arm nominal_;
  Arm real_;
};

double TurnBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Matrix3d turn = a.linear() * b.linear().transpose();
  return VectorFromRotation(turn).norm();
}

TEST_P(ProgramTest, TheRealArmGoesWhereTheProgramSays) {
  Random random(902);
  for (int i = 0; i < kPrograms; ++i) {
    Program program;
    language().make(i, &random, nominal_, &program);
    const std::string text = TextOf(program);
    const std::string in = directory_ / language().file;
    const std::string out =
        directory_ / (std::string("out_") + language().file);
    WriteWhole(in, text);
    const auto result = Correct(in, out);
    ASSERT_EQ(result.status, 0) << result.err << text;
    const auto corrected = Between(program, ReadWhole(out));
    ASSERT_EQ(corrected.size(), program.positions.size());
    for (std::size_t k = 0; k < corrected.size(); ++k) {
      const Position& position = program.positions[k];
      const auto numbers = NumbersIn(corrected[k]);
      const Eigen::Isometry3d reached = Reached(position, numbers);
      const Eigen::Isometry3d asked =
          position.is_joints
              ? position.frame.inverse() *
                    TargetPose(nominal_, position.joints) * position.tool
              : position.pose;
      // Both texts are rounded; angles by the distance to the base.
      const double angle = language().angle_digit;
      EXPECT_LT((reached.translation() - asked.translation()).norm(),
                3.0 * language().length_digit + 6.0 * angle)
          << language().name << " " << i << " " << corrected[k];
      EXPECT_LT(TurnBetween(reached, asked), 6.0 * angle);
      // And it was not there before.
      const Eigen::Isometry3d before =
          Reached(position, NumbersIn(language().write(position)));
      EXPECT_GT((before.translation() - asked.translation()).norm(), 1e-4);
    }
  }
}

TEST_P(ProgramTest, InverseRestoresTheNumbers) {
  Random random(903);
  for (int i = 0; i < kPrograms; ++i) {
    Program program;
    language().make(i, &random, nominal_, &program);
    const std::string in = directory_ / language().file;
    const std::string out =
        directory_ / (std::string("out_") + language().file);
    const std::string back =
        directory_ / (std::string("back_") + language().file);
    WriteWhole(in, TextOf(program));
    ASSERT_EQ(Correct(in, out).status, 0);
    const auto result = Correct(out, back, "--inverse");
    ASSERT_EQ(result.status, 0) << result.err;
    const auto restored = Between(program, ReadWhole(back));
    for (std::size_t k = 0; k < restored.size(); ++k) {
      const auto before = NumbersIn(language().write(program.positions[k]));
      const auto after = NumbersIn(restored[k]);
      const auto digits = LastDigitsIn(language().write(program.positions[k]));
      ASSERT_EQ(before.size(), after.size());
      for (std::size_t n = 0; n < before.size(); ++n) {
        // Half a unit of the last digit each way, and what the numbers that
        // were rounded with it turn it by.
        EXPECT_NEAR(after[n], before[n], 1.6 * digits[n]) << restored[k];
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Languages, ProgramTest,
                         ::testing::Values(&UrScript, &Krl, &KrlSource, &Rapid,
                                           &Fanuc),
                         [](const auto& language) {
                           return std::string(language.param().name);
                         });

class RefusedProgramTest : public ::testing::Test {
 protected:
  // The message, with nothing written.
  std::string Refusal(const std::string& file, const std::string& text,
                      const std::string& robot = "irb120") {
    const std::string arm = kSource + "/configs/robots/" + robot + ".yaml";
    WriteWhole(directory_ / file, text);
    const std::string out = directory_ / ("out_" + file);
    const auto result = testing::RunProcess(
        std::string(ALIDADE_BINARY) + " correct " + arm + " " +
        (directory_ / file) + " --nominal=" + arm + " --out=" + out);
    EXPECT_EQ(result.status, 2) << text;
    EXPECT_FALSE(std::filesystem::exists(out));
    return result.err;
  }

  const TemporaryDirectory directory_;
};

TEST_F(RefusedProgramTest, WhatIsComputedAtRunTimeIsListedAndStays) {
  const std::string arm = kSource + "/configs/robots/irb120.yaml";
  const std::string text =
      "DEF a()\nPTP {A1 0,A2 10,A3 5,A4 0,A5 30,A6 0}\nPTP XP7 C_PTP\n"
      "LIN_REL {Z 10}\nLIN XP7:{X 1,Y 2,Z 3,A 0,B 0,C 0}\nEND\n";
  WriteWhole(directory_ / "a.src", text);
  const auto result =
      testing::RunProcess(std::string(ALIDADE_BINARY) + " correct " + arm +
                          " " + (directory_ / "a.src") + " --nominal=" + arm +
                          " --out=" + (directory_ / "b.src"));
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* line : {"line 3: moves to XP7", "line 4: LIN_REL moves",
                           "line 5: a position is computed"}) {
    EXPECT_THAT(result.out, HasSubstr(line));
  }
  // The nominal arm itself: nothing moves but decimals that a controller shows.
  const std::string out = ReadWhole(directory_ / "b.src");
  EXPECT_THAT(out, HasSubstr("{A1 0.0000,A2 10.0000,A3 5.0000,A4 0.0000,"));
  EXPECT_EQ(out.substr(out.find("PTP XP7")), text.substr(text.find("PTP XP7")));
}

// On a UR the installation's tool holds then, and the program does not say it.
TEST_F(RefusedProgramTest, AToolThatIsNotSetIsAssumedAloudOrTakenFromTheTable) {
  const std::string arm = kSource + "/configs/robots/ur10.yaml";
  Random random(904);
  const Arm real = testing::WithRandomErrors(LoadArm(arm), &random);
  WriteWhole(directory_ / "real.yaml", FormatArm(real, ""));
  WriteWhole(directory_ / "frames.csv",
             "name,x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg\ntool,0,50,200,0,0,0\n");
  const std::string move = "movel(p[0.4,0.2,0.5,0,3.1,0])\n";
  const std::string tool = "set_tcp(p[0,0.05,0.2,0,0,0])\n";
  const auto correct = [&](const std::string& text, const std::string& more) {
    WriteWhole(directory_ / "a.script", text);
    const auto result = testing::RunProcess(
        std::string(ALIDADE_BINARY) + " correct " + (directory_ / "real.yaml") +
        " " + (directory_ / "a.script") + " --nominal=" + arm +
        " --out=" + (directory_ / "b.script") + more);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  const std::string frames = " --frames=" + (directory_ / "frames.csv");
  EXPECT_THAT(correct(move + "movej([0,-1,1,0,1,0])\n" + move, ""),
              HasSubstr("Assumed\n  line 1 and 1 other position: the program "
                        "sets no tool"));
  const std::string at_flange = ReadWhole(directory_ / "b.script");
  EXPECT_THAT(correct(move, frames),
              ::testing::Not(HasSubstr("the program sets no")));
  const std::string by_table = ReadWhole(directory_ / "b.script");
  WriteWhole(directory_ / "based.csv",
             "name,x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg\n"
             "tool,0,50,200,0,0,0\nbase,0,500,0,0,0,0\n");
  EXPECT_THAT(correct(move, " --frames=" + (directory_ / "based.csv")),
              HasSubstr("Assumed\n  poses are in the robot's own base: "));
  EXPECT_EQ(ReadWhole(directory_ / "b.script"), by_table);
  EXPECT_THAT(correct(tool + move, ""),
              ::testing::Not(HasSubstr("the program sets no")));
  EXPECT_EQ(ReadWhole(directory_ / "b.script"), tool + by_table);
  EXPECT_NE(at_flange.substr(0, by_table.size()), by_table);
  // Tools begin at the nominal arm's target, which is a reflector here.
  Arm with_tool = LoadArm(arm);
  with_tool.last_from_target().translation().z() += 0.04;
  WriteWhole(directory_ / "tool.yaml", FormatArm(with_tool, ""));
  EXPECT_THAT(correct(tool + move, " --nominal=" + (directory_ / "tool.yaml")),
              HasSubstr("Assumed\n  the program's tools begin at the arm "
                        "file's target, 40.0 mm from"));
}

TEST_F(RefusedProgramTest, ALineIsNotedOnceAndMotionsBySpeedAreToo) {
  const std::string arm = kSource + "/configs/robots/ur10.yaml";
  WriteWhole(directory_ / "a.script",
             "movel(pose_trans(p[0.4,0.2,0.5,0,3.1,0], p[0,0,0.1,0,0,0]))\n"
             "speedl([0,0,0.1,0,0,0], a=1, t=2)\nservoj(q_now, t=0.1)\n");
  const auto result = testing::RunProcess(
      std::string(ALIDADE_BINARY) + " correct " + arm + " " +
      (directory_ / "a.script") + " --nominal=" + arm +
      " --out=" + (directory_ / "b.script"));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(
      result.out,
      HasSubstr("Not touched\n  line 1: pose_trans computes with a pose\n"
                "  line 2: speedl moves by a speed, to no position\n"
                "  line 3: moves to what is computed at run time\n"));
}

TEST_F(RefusedProgramTest, WhatIsNotUnderstoodIsNamedByItsLine) {
  EXPECT_THAT(Refusal("a.src", "DEF a()\nPTP {A1 0,A2 0}\nEND\n"),
              HasSubstr("line 2: states only some of A1 to A6"));
  EXPECT_THAT(
      Refusal("a.src",
              "DEF a()\n$BASE=mine\nLIN {X 1,Y 2,Z 3,A 0,B 0,C 0}\nEND\n"),
      HasSubstr("line 3: its tool or base is set at run time"));
  EXPECT_THAT(
      Refusal("a.src",
              "DEF a()\nBAS(#TOOL,4)\nLIN {X 1,Y 2,Z 3,A 0,B 0,C 0}\nEND\n"),
      HasSubstr("tool 4 is not stated"));
  EXPECT_THAT(
      Refusal("a.dat",
              "DECL E6POS XP1={X 400,Y 0,Z 600,A 0,B 90,C 0,S 2,T 0,E1 7}\n"),
      HasSubstr("external axis (E1)"));
  EXPECT_THAT(
      Refusal("a.script",
              "p1=p[0.4,0,0.5,0,3.1,0]\nmovel(p1)\n"
              "p1[2]=0.3\n",
              "ur10"),
      HasSubstr("p1 is moved to and also used otherwise (line 3): let a "
                "variable of its own"));
  EXPECT_THAT(Refusal("a.script", "movel(p[9,0,0.5,0,3.1,0])\n", "ur10"),
              HasSubstr("line 1: out of reach"));
  EXPECT_THAT(Refusal("a.mod",
                      "MoveL [[400,0,500],[0,0,1,0],[0,0,0,0],[5,9E9,9E9,9E9,"
                      "9E9,9E9]],v1,z1,tool0;\n"),
              HasSubstr("external axis"));
  EXPECT_THAT(Refusal("a.mod",
                      "MoveL [[400,0,500],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,"
                      "9E9,9E9]],v1,z1,gun;\n"),
              HasSubstr("gun is not stated"));
  EXPECT_THAT(Refusal("a.ls",
                      "/POS\nP[1]{\n   GP1:\n\tUF : 0, UT : 0,\n\tJ1= 0.000 "
                      "deg,\tJ2= 0.000 deg\n};\n/END\n"),
              HasSubstr("states only some of its numbers"));
}

}  // namespace
}  // namespace alidade::internal::program_test
