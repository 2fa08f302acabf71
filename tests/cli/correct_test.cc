// `alidade fk`, `ik`, `correct` and `export` as they are run, against 4 x 4
// products in extended precision and readers of their own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "tests/support/error_term_kinematics.h"
#include "tests/support/process.h"

namespace alidade::internal {
namespace {

using testing::ErrorTermKinematics;
using ::testing::HasSubstr;
using ::testing::Not;
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
        std::snprintf(cell.data(), cell.size(), ",%.4f",
                      bend + random.Uniform(-25.0, 25.0));
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
  EXPECT_THAT(alone.err, HasSubstr("--nominal"));
}

// A URDF of six joints with comments, odd spacing and a fixed link.
std::string Urdf() {
  return "<?xml version=\"1.0\"?>\n<robot name='r'>\n"
         "  <!-- <joint name=\"j1\"><parent link=\"x\"/><origin/></joint> -->\n"
         "  <link name=\"base\"/><link name=\"l1\"/><link name=\"l2\"/>\n"
         "  <link name=\"l3\"/><link name=\"l4\"/><link name=\"l5\"/>\n"
         "  <link name=\"l6\"/><link name=\"tip\"/><link name=\"mid\"/>\n"
         "  <joint name=\"j1\" type=\"revolute\">\n"
         "    <parent link=\"base\"/><child link=\"l1\"/>\n"
         "    <origin rpy=\"0 0 0.1\"   xyz='0 0 0.29' />\n"
         "    <axis xyz=\"0 0 1\"/><limit lower=\"-2\" upper=\"2\"/>\n"
         "  </joint>\n"
         "  <joint name=\"j2\" type=\"revolute\"><parent link=\"l1\"/>"
         "<child link=\"l2\"/><axis xyz=\"0 1 0\"/>"
         "<limit lower=\"-1.5\" upper=\"1.5\"/></joint>\n"
         "  <joint name=\"m\" type=\"fixed\"><parent link=\"l2\"/>"
         "<child link=\"mid\"/><origin xyz=\"0 0 0.1\"/></joint>\n"
         "  <joint name=\"j3\" type=\"revolute\"><parent link=\"mid\"/>"
         "<child link=\"l3\"/><origin xyz=\"0 0 0.17\"/><axis xyz=\"0 1 0\"/>"
         "<limit lower=\"-1.5\" upper=\"1.2\"/></joint>\n"
         "  <joint name=\"j4\" type=\"revolute\"><parent link=\"l3\"/>"
         "<child link=\"l4\"/><origin xyz=\"0.15 0 0.07\" rpy=\"0 0 0\"/>"
         "<axis xyz=\"1 0 0\"/><limit lower=\"-2\" upper=\"2\"/></joint>\n"
         "  <joint name=\"j5\" type=\"revolute\"><parent link=\"l4\"/>"
         "<child link=\"l5\"/><origin xyz=\"0.15 0 0\"/><axis xyz=\"0 1 0\"/>"
         "<limit lower=\"-2\" upper=\"2\"/></joint>\n"
         "  <joint name=\"j6\" type=\"revolute\"><parent link=\"l5\"/>"
         "<child link=\"l6\"/><origin xyz=\"0.07 0 0\"/><axis xyz=\"1 0 0\"/>"
         "<limit lower=\"-2\" upper=\"2\"/></joint>\n"
         "  <joint name=\"t\" type=\"fixed\"><parent link=\"l6\"/>"
         "<child link=\"tip\"/><origin xyz=\"0.02 0 0\" rpy=\"0 1.5708 0\"/>"
         "</joint>\n  <transmission><joint name=\"j1\"/></transmission>\n"
         "</robot>\n";
}

// A reader of its own: all it knows is the file above.
Eigen::Matrix4d UrdfPose(const std::string& text, const Eigen::VectorXd& q) {
  testing::Matrix4l pose = testing::Matrix4l::Identity();
  const auto numbers = [](const std::string& part, const std::string& pattern) {
    std::smatch match;
    testing::Vector3l found = testing::Vector3l::Zero();
    if (!std::regex_search(part, match, std::regex(pattern))) return found;
    std::istringstream words(match[1]);
    for (int k = 0; k < 3; ++k) {
      std::string word;
      words >> word;
      found[k] = std::stold(word);
    }
    return found;
  };
  int moving = 0;
  for (const char* name : {"j1", "j2", "m", "j3", "j4", "j5", "j6", "t"}) {
    const std::string tag = std::string("<joint name=\"") + name + "\" type=";
    const std::size_t begin = text.find(tag);
    const std::string part =
        text.substr(begin, text.find("</joint>", begin) - begin);
    const std::string origin = "<origin[^>]*";
    const testing::Vector3l xyz =
        numbers(part, origin + R"(xyz=["']([^"']*)["'])");
    const testing::Vector3l rpy =
        numbers(part, origin + R"(rpy=["']([^"']*)["'])");
    pose = pose * testing::Translation(xyz) * testing::RotationZ(rpy.z()) *
           testing::RotationY(rpy.y()) * testing::RotationX(rpy.x());
    if (name[0] != 'j') continue;
    const testing::Vector3l axis = numbers(part, "<axis xyz=\"([^\"]*)\"");
    testing::Matrix4l turn = testing::Matrix4l::Identity();
    turn.topLeftCorner<3, 3>() = testing::MatrixFromVector(axis * q[moving++]);
    pose = pose * turn;
  }
  return pose.cast<double>();
}

TEST(ExportTest, AUrdfHoldsAllGeometryAndKeepsEveryOtherByte) {
  const TemporaryDirectory directory;
  WriteWhole(directory / "r.urdf", Urdf());
  WriteWhole(directory / "nominal.yaml",
             "format: alidade-arm-1\nname: r\nunits: {length: mm, angle: "
             "deg}\nurdf: {file: r.urdf, base_link: base, tip_link: tip}\n");
  const Arm nominal = LoadArm(directory / "nominal.yaml");
  Random random(921);
  Arm real = testing::WithRandomErrors(nominal, &random);
  real.errors = {};
  WriteWhole(directory / "real.yaml", FormatArm(real, ""));
  const auto result =
      Alidade("export " + (directory / "real.yaml") +
              " --as=urdf --nominal=" + (directory / "nominal.yaml") +
              " --out=" + (directory / "new.urdf"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("differs from the calibrated arm"));
  const std::string text = ReadWhole(directory / "new.urdf");
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd q(6);
    for (double& value : q) value = random.Uniform(-1.2, 1.2);
    EXPECT_LT((UrdfPose(text, q) - Pose(real, q)).norm(), 1e-12);
    EXPECT_LT((UrdfPose(Urdf(), q) - Pose(nominal, q)).norm(), 1e-12);
  }
  const std::regex origin(R"(<origin[^>]*/>)");
  EXPECT_EQ(std::regex_replace(text, origin, ""),
            std::regex_replace(Urdf(), origin, ""));
}

TEST(ExportTest, TheKinematicsFileOfUniversalRobotsComesBack) {
  const TemporaryDirectory directory;
  const std::string nominal_path = kRobots + "ur10.yaml";
  const Arm nominal = LoadArm(nominal_path);
  Random random(922);
  Arm real = testing::WithRandomErrors(nominal, &random);
  real.errors = {};
  WriteWhole(directory / "real.yaml", FormatArm(real, ""));
  const std::string file = directory / "ur10_calibration.yaml";
  const auto result =
      Alidade("export " + (directory / "real.yaml") +
              " --as=ur --nominal=" + nominal_path + " --out=" + file);
  ASSERT_EQ(result.status, 0) << result.err;
  // By the equations of the driver's description package.
  const std::string text = ReadWhole(file);
  const auto value = [&](const std::string& link, const std::string& key) {
    const std::size_t begin = text.find("  " + link + ":\n");
    const std::size_t at = text.find("    " + key + ": ", begin);
    return std::stold(text.substr(at + key.size() + 6));
  };
  const Arm again = LoadArm(file);
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd q(6);
    for (double& angle : q) angle = random.Uniform(-3.0, 3.0);
    testing::Matrix4l pose = testing::Matrix4l::Identity();
    int j = 0;
    for (const char* link : {"shoulder", "upper_arm", "forearm", "wrist_1",
                             "wrist_2", "wrist_3"}) {
      pose = pose *
             testing::Translation(
                 {value(link, "x"), value(link, "y"), value(link, "z")}) *
             testing::RotationZ(value(link, "yaw")) *
             testing::RotationY(value(link, "pitch")) *
             testing::RotationX(value(link, "roll")) *
             testing::RotationZ(q[j++]);
    }
    EXPECT_LT((pose.cast<double>() - Pose(real, q)).norm(), 1e-12);
    EXPECT_LT((Pose(again, q) - Pose(real, q)).norm(), 1e-12);
  }
}

TEST(ExportTest, TablesSayWhatTheyLose) {
  const TemporaryDirectory directory;
  const std::string nominal_path = kRobots + "ur10.yaml";
  Random random(923);
  Arm real = testing::WithRandomErrors(LoadArm(nominal_path), &random);
  WriteWhole(directory / "real.yaml", FormatArm(real, ""));
  const auto largest = [&](const std::string& format) {
    const auto result =
        Alidade("export " + (directory / "real.yaml") + " --as=" + format +
                " --table=yaml --nominal=" + nominal_path +
                " --out=" + (directory / (format + ".yaml")));
    EXPECT_EQ(result.status, 0) << result.err;
    std::smatch match;
    const std::regex cost(R"(([0-9.e-]+)\s+mm\s+at\s+most)");
    EXPECT_TRUE(std::regex_search(result.out, match, cost)) << result.out;
    return match.empty() ? 0.0 : std::stod(match[1]);
  };
  const double mdh = largest("mdh");
  const double dh = largest("dh");
  const double offsets = largest("offsets");
  EXPECT_GT(mdh, 1e-3);
  EXPECT_LT(dh, offsets);
  // The cost is that of the file, by its own reader: craig's convention.
  const Arm table = LoadArm(directory / "mdh.yaml");
  double farthest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    Eigen::VectorXd q(6);
    for (double& angle : q) angle = random.Uniform(-kPi, kPi);
    farthest = std::max(farthest, Distance(Pose(table, q), Pose(real, q)));
  }
  EXPECT_NEAR(farthest / kMillimetre, mdh, 0.2 * mdh);
  // An arm without beta and errors loses nothing.
  real = LoadArm(nominal_path);
  for (Joint& joint : real.joints) joint.d += 1e-3;
  real.joints[0].d = 0.0;
  WriteWhole(directory / "real.yaml", FormatArm(real, ""));
  EXPECT_LT(largest("mdh"), 1e-9);
  EXPECT_LT(largest("dh"), 1e-9);
}

TEST(ExportTest, JsonIsTheArmFile) {
  const TemporaryDirectory directory;
  Random random(924);
  const Arm real =
      testing::WithRandomErrors(LoadArm(kRobots + "irb120.yaml"), &random);
  WriteWhole(directory / "real.yaml", FormatArm(real, ""));
  const std::string file = directory / "arm.json";
  ASSERT_EQ(Alidade("export " + (directory / "real.yaml") +
                    " --as=json --out=" + file)
                .status,
            0);
  const Arm again = LoadArm(file);
  Eigen::VectorXd q(6);
  q << 0.1, -0.4, 0.3, 1.0, -0.5, 0.2;
  EXPECT_LT((Pose(again, q) - Pose(real, q)).norm(), 1e-14);
  // The commands take it where they take a result, too.
  const auto exported = Alidade("export " + file + " --as=json");
  EXPECT_EQ(exported.status, 0) << exported.err;
  EXPECT_EQ(exported.out, ReadWhole(file));
}

// The product of the six origins, each followed by the joint's rotation.
Eigen::Isometry3d UrFlange(const std::string& text, const Eigen::VectorXd& q) {
  static const std::regex kNumber(R"((?:x|y|z|roll|pitch|yaw): *(\S+))");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), kNumber), end;
       it != end; ++it) {
    numbers.push_back(std::stod((*it)[1]));
  }
  EXPECT_EQ(numbers.size(), 36u);
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  for (int j = 0; j < 6; ++j) {
    const double* n = numbers.data() + std::ptrdiff_t{6} * j;
    flange = flange * Eigen::Translation3d(n[0], n[1], n[2]) *
             Eigen::AngleAxisd(n[5], Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(n[4], Eigen::Vector3d::UnitY()) *
             Eigen::AngleAxisd(n[3], Eigen::Vector3d::UnitX()) *
             Eigen::AngleAxisd(q[j], Eigen::Vector3d::UnitZ());
  }
  return flange;
}

TEST(ExportTest, KinematicsOfTheDriverSurviveARoundTrip) {
  std::string text = "kinematics:\n";
  const std::array<std::array<double, 6>, 6> numbers = {{
      {0, 0, 0.0892, 0, 0, 1.5e-5},
      {8.3e-5, 0, 0, 1.57028, 0, 9.4e-5},
      {-0.42515, 0, 0, 2.8e-4, 7.4e-4, 8.2e-5},
      {-0.39231, 7e-4, 0.11005, 3.1352, -3.1401, 3.14152},
      {3.7e-5, -0.09472, 1.8e-4, 1.5689, 0, -1.3e-5},
      {1.5e-4, 0.08242, 1.3e-4, 1.57233, 3.14159, -3.14158},
  }};
  const std::array<const char*, 6> links = {"shoulder", "upper_arm", "forearm",
                                            "wrist_1",  "wrist_2",   "wrist_3"};
  const std::array<const char*, 6> keys = {"x",    "y",     "z",
                                           "roll", "pitch", "yaw"};
  for (int j = 0; j < 6; ++j) {
    text += std::string("  ") + links[j] + ":\n";
    for (int k = 0; k < 6; ++k) {
      std::array<char, 48> line;
      std::snprintf(line.data(), line.size(), "    %s: %.9g\n", keys[k],
                    numbers[j][k]);
      text += line.data();
    }
  }
  text += "  hash: calib_1\n";
  const TemporaryDirectory directory;
  const std::string file = directory / "my_robot_kinematics.yaml";
  WriteWhole(file, text);
  const auto exported = Alidade("export " + file + " --as=ur");
  ASSERT_EQ(exported.status, 0) << exported.err;
  EXPECT_THAT(exported.err, Not(HasSubstr("not part of it")));
  Random random(925);
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd q(6);
    for (double& angle : q) angle = random.Uniform(-kPi, kPi);
    EXPECT_LT((UrFlange(exported.out, q).matrix() - UrFlange(text, q).matrix())
                  .norm(),
              1e-12);
  }
}

}  // namespace
}  // namespace alidade::internal
