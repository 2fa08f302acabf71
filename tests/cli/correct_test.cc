// `alidade fk`, `ik` and `correct` as they are run, against 4 x 4 products in
// extended precision.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"

namespace alidade::internal::correct_test {
namespace {

using testing::ErrorTermKinematics;
using ::testing::HasSubstr;
using testing::ReadWhole;
using testing::TemporaryDirectory;
using testing::WriteWhole;

const std::string kRobots =
    std::string(ALIDADE_SOURCE_DIR) + "/configs/robots/";

testing::ProcessResult Alidade(const std::string& arguments) {
  return testing::RunProcess(std::string(ALIDADE_BINARY) + " " + arguments);
}

// Columns by their names; texts are kept.
std::map<std::string, std::vector<std::string>> Columns(
    const std::string& text) {
  std::map<std::string, std::vector<std::string>> columns;
  std::vector<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (line.back() == '\r') line.pop_back();
    std::istringstream cells(line + ",");
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    if (names.empty()) {
      names = row;
      continue;
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      columns[names[k]].push_back(k < row.size() ? row[k] : "");
    }
  }
  return columns;
}

Eigen::VectorXd JointsOf(
    const std::map<std::string, std::vector<std::string>>& columns,
    const std::string& prefix, const Arm& arm, std::size_t row) {
  Eigen::VectorXd joints(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    const std::string name =
        prefix + "q" + std::to_string(j + 1) + (turns ? "_deg" : "_mm");
    joints[j] =
        std::stod(columns.at(name)[row]) * (turns ? kDegree : kMillimetre);
  }
  return joints;
}

Eigen::Matrix4d Pose(const Arm& arm, const Eigen::VectorXd& joints) {
  return ErrorTermKinematics(arm).TargetFrame(joints).cast<double>();
}

double TurnBetween(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  const Eigen::Matrix3d turn =
      a.topLeftCorner<3, 3>() * b.topLeftCorner<3, 3>().transpose();
  return VectorFromRotation(turn).norm();
}

double Distance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return (a - b).topRightCorner<3, 1>().norm();
}

class CorrectTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    nominal_path_ = kRobots + GetParam() + ".yaml";
    nominal_ = LoadArm(nominal_path_);
    Random random(911);
    real_ = testing::WithRandomErrors(nominal_, &random);
    real_path_ = directory_ / "real.yaml";
    WriteWhole(real_path_, FormatArm(real_, ""));
    std::string text = "# joint values\r\nnote";
    for (int j = 0; j < nominal_.num_joints(); ++j) {
      const bool turns = nominal_.joints[j].type == JointType::kRevolute;
      text += ",q" + std::to_string(j + 1) + (turns ? "_deg" : "_mm");
    }
    text += "\r\n";
    for (int i = 0; i < 20; ++i) {
      text += "row " + std::to_string(i);
      for (int j = 0; j < nominal_.num_joints(); ++j) {
        std::array<char, 32> cell;
        // Away from stretched elbows and wrists.
        const bool is_bent = j % 2 == 1 || nominal_.num_joints() == 6;
        const double bend = is_bent && j > 0 ? 35.0 : 0.0;
        double value = bend + random.Uniform(-25.0, 25.0);
        // The Panda's elbow bends to one side alone, and is stretched at -26.
        if (value * kDegree > nominal_.joints[j].upper) value = -value - 45.0;
        std::snprintf(cell.data(), cell.size(), ",%.4f", value);
        text += cell.data();
      }
      text += "\r\n";
    }
    joints_path_ = directory_ / "joints.csv";
    WriteWhole(joints_path_, text);
  }

  std::string Correct(const std::string& from, const std::string& more = "") {
    const std::string out = directory_ / "out.csv";
    const auto result =
        Alidade("correct " + real_path_ + " " + from +
                " --nominal=" + nominal_path_ + " --out=" + out + " " + more);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(ReadWhole(directory_ / "out.svg"), HasSubstr("</svg>"));
    return ReadWhole(out);
  }

  const TemporaryDirectory directory_;
  std::string nominal_path_;
  std::string real_path_;
  std::string joints_path_;
  Arm nominal_;
  Arm real_;
};

TEST_P(CorrectTest, JointValuesBringTheRealArmWhereTheNominalOneWouldBe) {
  const std::string text = Correct(joints_path_);
  const auto columns = Columns(text);
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_EQ(columns.at("status")[i], "reached");
    const Eigen::Matrix4d asked =
        Pose(nominal_, JointsOf(columns, "", nominal_, i));
    const Eigen::Matrix4d reached =
        Pose(real_, JointsOf(columns, "corrected_", nominal_, i));
    // Joint values are written to 1e-10 deg.
    EXPECT_LT(Distance(asked, reached), 1e-9);
    if (nominal_.num_joints() > 5) {
      EXPECT_LT(TurnBetween(asked, reached), 1e-7);
    }
  }
  // Everything that was there is there still.
  std::istringstream before(ReadWhole(joints_path_));
  std::istringstream after(text);
  for (std::string a, b; std::getline(before, a);) {
    ASSERT_TRUE(std::getline(after, b));
    if (!a.empty() && a.back() == '\r') {
      EXPECT_EQ(b.back(), '\r');
      a.pop_back();
    }
    EXPECT_EQ(b.substr(0, a.size()), a);
  }
}

TEST_P(CorrectTest, PosesAreCorrectedAndRestored) {
  const std::string poses = directory_ / "poses.csv";
  const auto fk = Alidade("fk " + nominal_path_ + " " + joints_path_ +
                          " --rotation=intrinsic_zyx --out=" + poses);
  ASSERT_EQ(fk.status, 0) << fk.err;
  const auto asked = Columns(ReadWhole(poses));
  const auto columns = Columns(Correct(poses, "--rotation=intrinsic_zyx"));
  std::string again = "x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg";
  for (int j = 0; j < nominal_.num_joints(); ++j) {
    const bool turns = nominal_.joints[j].type == JointType::kRevolute;
    again += ",q" + std::to_string(j + 1) + (turns ? "_deg" : "_mm");
  }
  again += "\n";
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_EQ(columns.at("status")[i], "reached");
    const Eigen::Matrix4d pose =
        Pose(nominal_, JointsOf(asked, "", nominal_, i));
    EXPECT_NEAR(std::stod(asked.at("x_mm")[i]), pose(0, 3) * 1e3, 1e-6);
    const Eigen::VectorXd joints = JointsOf(columns, "corrected_", nominal_, i);
    EXPECT_LT(Distance(pose, Pose(real_, joints)), 2e-9);
    // The pose to command is that of the joint values to command.
    const Eigen::Matrix4d command = Pose(nominal_, joints);
    EXPECT_NEAR(std::stod(columns.at("corrected_z_mm")[i]), command(2, 3) * 1e3,
                1e-6);
    std::string row;
    for (const char* name :
         {"x_mm", "y_mm", "z_mm", "rx_deg", "ry_deg", "rz_deg"}) {
      row += (row.empty() ? "" : ",") +
             columns.at(std::string("corrected_") + name)[i];
    }
    for (int j = 0; j < nominal_.num_joints(); ++j) {
      const bool turns = nominal_.joints[j].type == JointType::kRevolute;
      row += "," + columns.at("corrected_q" + std::to_string(j + 1) +
                              (turns ? "_deg" : "_mm"))[i];
    }
    again += row + "\n";
  }
  const std::string corrected = directory_ / "corrected.csv";
  WriteWhole(corrected, again);
  const auto restored =
      Columns(Correct(corrected, "--rotation=intrinsic_zyx --inverse"));
  for (std::size_t i = 0; i < 20; ++i) {
    for (const char* name : {"x_mm", "y_mm", "z_mm"}) {
      EXPECT_NEAR(std::stod(restored.at(std::string("restored_") + name)[i]),
                  std::stod(asked.at(name)[i]), 2e-6);
    }
    // Five joints lose a part of the orientation on the way.
    if (nominal_.num_joints() == 5) continue;
    for (const char* name : {"rx_deg", "ry_deg", "rz_deg"}) {
      EXPECT_NEAR(std::stod(restored.at(std::string("restored_") + name)[i]),
                  std::stod(asked.at(name)[i]), 1e-5);
    }
  }
}

TEST_P(CorrectTest, InverseKinematicsFindsWhatForwardKinematicsGives) {
  const std::string poses = directory_ / "poses.csv";
  ASSERT_EQ(Alidade("fk " + real_path_ + " " + joints_path_ + " --out=" + poses)
                .status,
            0);
  const auto found = Alidade("ik " + real_path_ + " " + poses);
  ASSERT_EQ(found.status, 0) << found.err;
  const auto columns = Columns(found.out);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(columns.at("status")[i], "reached");
    EXPECT_LT(Distance(Pose(real_, JointsOf(columns, "", real_, i)),
                       Pose(real_, JointsOf(columns, "ik_", real_, i))),
              2e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, CorrectTest,
                         ::testing::Values("rv2aj_flange", "ur10", "irb120",
                                           "panda", "lifting_column"));

TEST(CorrectErrorsTest, AreNamed) {
  const TemporaryDirectory directory;
  const std::string arm = kRobots + "irb120.yaml";
  const std::string table = directory / "t.csv";
  const auto refusal = [&](const std::string& text, const std::string& more) {
    WriteWhole(table, text);
    const auto result =
        Alidade("correct " + arm + " " + table + " --nominal=" + arm +
                " --out=" + (directory / "o.csv") + " " + more);
    EXPECT_EQ(result.status, 2) << text;
    EXPECT_FALSE(std::filesystem::exists(directory / "o.csv"));
    return result.err;
  };
  EXPECT_THAT(refusal("a,b\n1,2\n", ""), HasSubstr("neither joint values"));
  EXPECT_THAT(refusal("x_mm,y_mm,z_mm\n1,2,3\n", ""),
              HasSubstr("positions without orientations"));
  EXPECT_THAT(refusal("x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\n1,2,3,4,5,6\n", ""),
              HasSubstr("--rotation"));
  EXPECT_THAT(refusal("x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg\n1,2,,4,5,6\n", ""),
              HasSubstr("t.csv:2:"));
  EXPECT_THAT(refusal("x_mm,y_mm,z_mm,wx_deg,wy_deg,wz_deg,status\n"
                      "400,0,500,0,0,0,no\n",
                      ""),
              HasSubstr("is there already"));
  const auto alone = Alidade("correct " + arm + " " + table);
  EXPECT_EQ(alone.status, 2);
  EXPECT_THAT(alone.err, HasSubstr("calibrate first, and name the folder of"));
  EXPECT_THAT(alone.err, HasSubstr("--nominal"));
  WriteWhole(directory / "job.yaml", "format: alidade-job-2\n");
  const auto job =
      Alidade("correct " + directory.path().string() + " " + table);
  EXPECT_EQ(job.status, 2);
  EXPECT_THAT(job.err, HasSubstr("this folder holds a job, no result: "
                                 "`alidade calibrate "));
  const auto swapped =
      Alidade("correct " + table + " " + directory.path().string());
  EXPECT_EQ(swapped.status, 2);
  EXPECT_THAT(swapped.err, HasSubstr("expected the result first"));
}

TEST(CorrectErrorsTest, NoFileTakesThePlaceOfAnother) {
  const TemporaryDirectory directory;
  const std::string arm = kRobots + "irb120.yaml";
  const std::string table = directory / "t.csv";
  // The figure beside it has that ending, and would take its place.
  WriteWhole(table,
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,2,3,4,50,6\n");
  const auto figure =
      Alidade("correct " + arm + " " + table + " --nominal=" + arm +
              " --out=" + (directory / "o.svg"));
  EXPECT_EQ(figure.status, 2);
  EXPECT_THAT(figure.err, HasSubstr("expected another ending"));
  const std::string frames = directory / "f.csv";
  WriteWhole(frames,
             "name,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\ntool,0,0,9,0,0,0\n");
  const std::string program = directory / "p.src";
  WriteWhole(program, "PTP {A1 0,A2 -90,A3 90,A4 0,A5 40,A6 0}\n");
  const auto with_frames =
      Alidade("correct " + arm + " " + program + " --nominal=" + arm +
              " --frames=" + frames + " --out=" + frames);
  EXPECT_EQ(with_frames.status, 2);
  EXPECT_THAT(with_frames.err, HasSubstr("f.csv: is read by this run"));
  WriteWhole(frames,
             "name,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\ntool,0,0,9,0,0,0\n"
             "Tool,0,0,8,0,0,0\n");
  EXPECT_THAT(Alidade("correct " + arm + " " + program + " --nominal=" + arm +
                      " --frames=" + frames + " --out=" + (directory / "o.src"))
                  .err,
              HasSubstr("stands twice"));
}

// A file keeps its name, which controllers want to be the program's.
TEST(CorrectOutputTest, IsAFolderOfItsOwn) {
  const TemporaryDirectory directory;
  const std::string arm = kRobots + "irb120.yaml";
  WriteWhole(directory / "seam.src",
             "DEF seam()\nPTP {A1 0,A2 10,A3 5,A4 0,A5 30,A6 0}\nEND\n");
  const auto run = testing::RunProcess("cd " + directory.path().string() +
                                       " && " + ALIDADE_BINARY + " correct " +
                                       arm + " seam.src --nominal=" + arm);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("  results/corrected/seam.src\n"));
  EXPECT_THAT(ReadWhole(directory / "results/corrected/seam.src"),
              HasSubstr("DEF seam()"));
}

TEST(CorrectTableTest, PosturesThatNothingStatesAreListed) {
  const TemporaryDirectory directory;
  const std::string arm = kRobots + "irb120.yaml";
  WriteWhole(directory / "q.csv",
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,20,5,15,30,20\n");
  const std::string stated = directory / "stated.csv";
  ASSERT_EQ(
      Alidade("fk " + arm + " " + (directory / "q.csv") + " --out=" + stated)
          .status,
      0);
  const auto columns = Columns(ReadWhole(stated));
  std::string header;
  std::string row;
  for (const char* name :
       {"x_mm", "y_mm", "z_mm", "wx_deg", "wy_deg", "wz_deg"}) {
    header += (header.empty() ? "" : ",") + std::string(name);
    row += (row.empty() ? "" : ",") + columns.at(name)[0];
  }
  WriteWhole(directory / "poses.csv", header + "\n" + row + "\n");
  const auto correct = [&](const std::string& table) {
    return Alidade("correct " + arm + " " + table + " --nominal=" + arm +
                   " --out=" + (directory / "o.csv"));
  };
  EXPECT_THAT(correct(stated).out, ::testing::Not(HasSubstr("Assumed")));
  EXPECT_THAT(correct(directory / "poses.csv").out,
              ::testing::ContainsRegex("Assumed\n  no joint values beside the "
                                       "poses say .*row 1 is taken in q1 "));
  WriteWhole(directory / "far.csv",
             header + "\n99000,0,0,0,0,0\n" + row + "\n");
  EXPECT_THAT(correct(directory / "far.csv").out,
              HasSubstr("row 2 is taken in q1 "));
}

// As `plan --check` writes them.
TEST(CorrectTableTest, EmptyPosesCountAsAbsent) {
  const TemporaryDirectory directory;
  const std::string arm = kRobots + "irb120.yaml";
  const std::string header =
      "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,x_mm,y_mm,z_mm\n";
  const auto correct = [&](const std::string& rows) {
    WriteWhole(directory / "t.csv", header + rows);
    return Alidade("correct " + arm + " " + (directory / "t.csv") +
                   " --nominal=" + arm + " --out=" + (directory / "o.csv"));
  };
  const auto empty = correct("0,10,5,0,30,0,,,\n1,10,5,0,30,0,,,\n");
  EXPECT_EQ(empty.status, 0) << empty.err;
  const auto columns = Columns(ReadWhole(directory / "o.csv"));
  EXPECT_EQ(columns.at("corrected_q1_deg").size(), 2u);
  const auto some = correct("0,10,5,0,30,0,,,\n1,10,5,0,30,0,1,2,3\n");
  EXPECT_EQ(some.status, 2);
  EXPECT_THAT(some.err, HasSubstr("t.csv:2:"));
}

// The posture of a pose is that of the position which the program moves to
// before, wherever that is stated.
TEST(CorrectProgramTest, PostureIsThatOfThePositionMovedToBefore) {
  const TemporaryDirectory scratch;
  std::string arm = ReadWhole(kRobots + "ur10.yaml");
  const std::string length = "a: -572.3";
  ASSERT_NE(arm.find(length), std::string::npos);
  arm.replace(arm.find(length), length.size(), "a: -574.3");
  WriteWhole(scratch / "real.yaml", arm);
  const std::string list = "[0.1, -0.4, -1.6, 0.2, -1.5708, 0.3]";
  const std::string away = "  movej([0.1, -1.9, 1.57, -1.74, 1.5708, 0.0])\n";
  const auto corrected = [&](const std::string& name,
                             const std::string& moves) {
    // Where the list puts the nominal arm, by `fk`.
    WriteWhole(scratch / "q.csv",
               "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n"
               "0.1,-0.4,-1.6,0.2,-1.5708,0.3\n");
    const auto pose = Columns(
        Alidade("fk " + kRobots + "ur10.yaml " + (scratch / "q.csv")).out);
    std::string text = "p[";
    for (const char* key : {"x_mm", "y_mm", "z_mm"}) {
      text += std::to_string(1e-3 * std::stod(pose.at(key)[0])) + ", ";
    }
    for (const char* key : {"wx_deg", "wy_deg", "wz_deg"}) {
      text += std::to_string(std::stod(pose.at(key)[0]) * kDegree) +
              (key[1] == 'z' ? "]" : ", ");
    }
    const std::string file = scratch / name;
    WriteWhole(file, "def main():\n" + moves + "  movel(" + text + ")\nend\n");
    const auto run = Alidade("correct " + (scratch / "real.yaml") + " " + file +
                             " --nominal=" + kRobots +
                             "ur10.yaml --out=" + (scratch / ("out_" + name)));
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string out = ReadWhole(scratch / ("out_" + name));
    const std::size_t at = out.find("movel");
    return at == std::string::npos ? "" : out.substr(at);
  };
  const std::string inline_list =
      corrected("inline.script", away + "  movej(" + list + ")\n");
  EXPECT_EQ(corrected("declared.script",
                      "  jB = " + list + "\n" + away + "  movej(jB)\n"),
            inline_list);
  // In another posture the same pose is corrected otherwise.
  EXPECT_NE(corrected("other.script", "  movej(" + list + ")\n" + away),
            inline_list);
}

}  // namespace
}  // namespace alidade::internal::correct_test
