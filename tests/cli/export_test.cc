// `alidade export` as it is run, against 4 x 4 products in extended precision
// and readers of its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
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

namespace alidade::internal::export_test {
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

Eigen::Matrix4d Pose(const Arm& arm, const Eigen::VectorXd& joints) {
  return ErrorTermKinematics(arm).TargetFrame(joints).cast<double>();
}

double Distance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return (a - b).topRightCorner<3, 1>().norm();
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
class UrdfChain {
 public:
  explicit UrdfChain(const std::string& text) {
    for (const char* name : {"j1", "j2", "m", "j3", "j4", "j5", "j6", "t"}) {
      const std::string tag = std::string("<joint name=\"") + name + "\" type=";
      const std::size_t begin = text.find(tag);
      const std::string part =
          text.substr(begin, text.find("</joint>", begin) - begin);
      const std::string origin = "<origin[^>]*";
      const testing::Vector3l xyz =
          Numbers(part, origin + R"(xyz=["']([^"']*)["'])");
      const testing::Vector3l rpy =
          Numbers(part, origin + R"(rpy=["']([^"']*)["'])");
      links_.push_back(
          {testing::Translation(xyz) * testing::RotationZ(rpy.z()) *
               testing::RotationY(rpy.y()) * testing::RotationX(rpy.x()),
           name[0] == 'j', Numbers(part, "<axis xyz=\"([^\"]*)\"")});
    }
  }

  Eigen::Matrix4d Pose(const Eigen::VectorXd& q) const {
    testing::Matrix4l pose = testing::Matrix4l::Identity();
    int moving = 0;
    for (const Link& link : links_) {
      pose = pose * link.origin;
      if (!link.moves) continue;
      testing::Matrix4l turn = testing::Matrix4l::Identity();
      turn.topLeftCorner<3, 3>() =
          testing::MatrixFromVector(link.axis * q[moving++]);
      pose = pose * turn;
    }
    return pose.cast<double>();
  }

 private:
  struct Link {
    testing::Matrix4l origin;
    bool moves;
    testing::Vector3l axis;
  };

  static testing::Vector3l Numbers(const std::string& part,
                                   const std::string& pattern) {
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
  }

  std::vector<Link> links_;
};

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
  const UrdfChain calibrated(text);
  const UrdfChain as_it_was(Urdf());
  for (int i = 0; i < 1000; ++i) {
    Eigen::VectorXd q(6);
    for (double& value : q) value = random.Uniform(-1.2, 1.2);
    EXPECT_LT((calibrated.Pose(q) - Pose(real, q)).norm(), 1e-12);
    EXPECT_LT((as_it_was.Pose(q) - Pose(nominal, q)).norm(), 1e-12);
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
}  // namespace alidade::internal::export_test
