#include "alidade/arm_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "alidade/parameter_layout.h"
#include "alidade/rotation.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/files.h"
#include "src/common/random.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::arm_file_test {
namespace {

const char kHeader[] =
    "format: alidade-arm-1\n"
    "name: test\n"
    "units: {length: mm, angle: deg}\n";

Arm LoadText(const std::string& text) {
  const TestDirectory directory;
  return LoadArm(directory.Write("arm.yaml", text));
}

TEST(ArmFileTest, AnArmThatComesWithAlidadeByItsName) {
  std::vector<std::string> inputs;
  const Arm arm = LoadArm("robots/rv2aj_wrist", &inputs);
  EXPECT_EQ(
      arm.name,
      LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"), &inputs).name);
  ExpectInputError([] { LoadArm("robots/rv2aj_wrisk"); },
                   {0, 0, "", "rv2aj_wrist"});
}

TEST(LoadArmTest, ReadsTheWristArmOfTheStudy) {
  const Arm arm = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  ASSERT_EQ(arm.num_joints(), 5);
  const double alpha_deg[] = {0, -90, 0, 0, 90};
  const double d_m[] = {0, 0, 0.25, 0.16, 0};
  const double theta_deg[] = {0, -90, 0, 90, 0};
  const double r_m[] = {0.3, 0, 0, 0, 0};
  const double lower_deg[] = {-150, -60, -110, -90, -200};
  const double upper_deg[] = {150, 120, 120, 90, 200};
  for (int j = 0; j < 5; ++j) {
    const Joint& joint = arm.joints[j];
    EXPECT_EQ(joint.type, JointType::kRevolute);
    EXPECT_EQ(joint.beta, 0.0);
    EXPECT_EQ(joint.alpha, alpha_deg[j] * kDegree);
    EXPECT_EQ(joint.d, d_m[j]);
    EXPECT_EQ(joint.theta, theta_deg[j] * kDegree);
    EXPECT_EQ(joint.r, r_m[j]);
    EXPECT_EQ(joint.lower, lower_deg[j] * kDegree);
    EXPECT_EQ(joint.upper, upper_deg[j] * kDegree);
  }
  EXPECT_EQ(arm.instrument_from_base.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(arm.last_from_target().matrix(), Eigen::Matrix4d::Identity());
}

TEST(LoadArmTest, FlangeArmDiffersFromTheWristArmInR5Only) {
  const Arm wrist = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  const Arm flange = LoadArm(SourcePath("configs/robots/rv2aj_flange.yaml"));
  const ParameterLayout layout(5);
  Eigen::VectorXd difference = layout.Values(flange) - layout.Values(wrist);
  EXPECT_EQ(difference[layout.Column(ParameterKind::kR, 4)], 0.072);
  difference[layout.Column(ParameterKind::kR, 4)] = 0.0;
  EXPECT_TRUE(difference.isZero(0.0));
}

TEST(LoadArmTest, ReadsAPrismaticJointsLimitsAsLengths) {
  const Arm arm =
      LoadText(std::string(kHeader) +
               "joints:\n"
               "  - {type: prismatic, r: 100, theta: 45, limits: [-5, 500]}\n");
  EXPECT_EQ(arm.joints[0].type, JointType::kPrismatic);
  EXPECT_EQ(arm.joints[0].r, 0.1);
  EXPECT_EQ(arm.joints[0].theta, 45.0 * kDegree);
  EXPECT_EQ(arm.joints[0].lower, -0.005);
  EXPECT_EQ(arm.joints[0].upper, 0.5);
}

TEST(LoadArmTest, LeavesAJointWithoutLimitsUnlimited) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "joints: [{type: revolute}, "
                           "{type: revolute, limits: [-90, .inf]}]\n");
  EXPECT_EQ(arm.joints[0].lower, -kInfinity);
  EXPECT_EQ(arm.joints[0].upper, kInfinity);
  EXPECT_EQ(arm.joints[1].lower, -kPi / 2.0);
  EXPECT_EQ(arm.joints[1].upper, kInfinity);
}

TEST(LoadArmTest, ReadsFramesWithRotationVectors) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "joints: [{type: revolute}]\n"
                           "base: {x: 1, y: 2, z: 3, rz: 90}\n"
                           "tool: {z: 50}\n");
  const Eigen::Isometry3d& base = arm.instrument_from_base;
  EXPECT_EQ(base.translation(), Eigen::Vector3d(0.001, 0.002, 0.003));
  // A quarter turn about z takes x to y.
  const Eigen::Vector3d turned = base.linear() * Eigen::Vector3d::UnitX();
  EXPECT_LT((turned - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_EQ(arm.last_from_target().translation(), Eigen::Vector3d(0, 0, 0.05));
  EXPECT_EQ(arm.last_from_target().linear(), Eigen::Matrix3d::Identity());
}

struct ArmErrorCase {
  const char* name;
  std::string text;
  ExpectedError expected;
};

void PrintTo(const ArmErrorCase& error_case, std::ostream* out) {
  *out << error_case.name;
}

class LoadArmErrorTest : public ::testing::TestWithParam<ArmErrorCase> {};

TEST_P(LoadArmErrorTest, NamesLineColumnKeyAndWhatWasExpected) {
  ExpectInputError([&] { LoadText(GetParam().text); }, GetParam().expected);
}

std::string WithJoints(const std::string& joints) {
  return kHeader + ("joints:\n" + joints);
}

std::string CaseName(const ::testing::TestParamInfo<ArmErrorCase>& info) {
  return info.param.name;
}

std::string ManyJoints(int count) {
  std::string joints;
  for (int j = 0; j < count; ++j) joints += "  - {type: revolute}\n";
  return joints;
}

INSTANTIATE_TEST_SUITE_P(
    Arms, LoadArmErrorTest,
    ::testing::Values(
        ArmErrorCase{"NoFormat",
                     "name: x\n",
                     {1, 1, "", "expected a map with the key \"format\""}},
        ArmErrorCase{"RootIsList",
                     "- 1\n",
                     {1, 1, "", "expected a map with the key \"format\""}},
        ArmErrorCase{"OtherFormat",
                     "format: alidade-job-1\n",
                     {1, 9, "format",
                      "found \"alidade-job-1\", expected \"alidade-arm-1\""}},
        ArmErrorCase{"UnknownFormat",
                     "format: alidade-arm-2\n",
                     {1, 9, "format",
                      "unknown format \"alidade-arm-2\", did you mean "
                      "\"alidade-arm-1\"?"}},
        ArmErrorCase{"NoUnits",
                     "format: alidade-arm-1\nname: x\n",
                     {1, 1, "units", "missing, expected this key"}},
        ArmErrorCase{"NoJoints",
                     kHeader,
                     {1, 1, "joints", "missing, expected this key"}},
        ArmErrorCase{"EmptyJoints",
                     kHeader + std::string("joints: []\n"),
                     {4, 9, "joints", "expected 1 to 64 joints, found 0"}},
        ArmErrorCase{"TooManyJoints",
                     WithJoints(ManyJoints(65)),
                     {5, 3, "joints", "expected 1 to 64 joints, found 65"}},
        ArmErrorCase{"NoType",
                     WithJoints("  - {r: 1}\n"),
                     {5, 5, "joints[1].type", "missing, expected this key"}},
        ArmErrorCase{"UnknownType",
                     WithJoints("  - {type: rotary}\n"),
                     {5, 12, "joints[1].type",
                      "unknown joint type \"rotary\", expected one of "
                      "revolute, prismatic"}},
        ArmErrorCase{"UnknownKey",
                     WithJoints("  - {type: revolute}\n"
                                "  - {type: revolute, aplha: 3}\n"),
                     {6, 22, "joints[2].aplha", "did you mean \"alpha\"?"}},
        ArmErrorCase{"LimitsSwapped",
                     WithJoints("  - {type: revolute, limits: [90, -90]}\n"),
                     {5, 30, "joints[1].limits",
                      "the upper limit -90 is below the lower one 90"}},
        ArmErrorCase{"OneLimit",
                     WithJoints("  - {type: revolute, limits: [90]}\n"),
                     {5, 30, "joints[1].limits",
                      "expected a list of 2 (lower, upper), found 1"}},
        ArmErrorCase{
            "LimitIsNan",
            WithJoints("  - {type: revolute, limits: [.nan, 1]}\n"),
            {5, 31, "joints[1].limits[1]", "expected a finite number"}},
        ArmErrorCase{"UnknownConvention",
                     kHeader + std::string("convention: paul\n"),
                     {4, 13, "convention", "khalil, craig, standard"}},
        ArmErrorCase{
            "KeyOfAnotherConvention",
            kHeader + std::string("convention: craig\n"
                                  "joints: [{type: revolute, r: 1}]\n"),
            {5, 27, "joints[1].r", "type, theta, d, a, alpha"}},
        ArmErrorCase{"SignIsTwo",
                     WithJoints("  - {type: revolute, sign: 2}\n"),
                     {5, 28, "joints[1].sign", "expected 1 or -1"}},
        ArmErrorCase{"SingularMotors",
                     WithJoints("  - {type: revolute}\n"
                                "  - {type: revolute}\n") +
                         "motors: {matrix: [[1, 1], [1, 1]]}\n",
                     {7, 18, "motors.matrix", "singular"}},
        ArmErrorCase{"MotorsAndSigns",
                     WithJoints("  - {type: revolute, sign: -1}\n") +
                         "motors: {offset: [1]}\n",
                     {6, 9, "motors", "found both"}},
        ArmErrorCase{"ToolAndTargets",
                     WithJoints("  - {type: revolute}\n") +
                         "tool: {x: 1}\ntargets: [{name: a}]\n",
                     {7, 10, "targets", "found beside \"tool\""}},
        ArmErrorCase{"NoTargets",
                     WithJoints("  - {type: revolute}\n") + "targets: []\n",
                     {6, 10, "targets", "expected 1 to 64 targets, found 0"}},
        ArmErrorCase{
            "TargetWithoutName",
            WithJoints("  - {type: revolute}\n") + "targets: [{x: 1}]\n",
            {6, 11, "targets[1].name", "missing"}},
        ArmErrorCase{"RepeatedTarget",
                     WithJoints("  - {type: revolute}\n") +
                         "targets: [{name: a}, {name: a}]\n",
                     {6, 29, "targets[2].name", "\"a\" is repeated"}},
        ArmErrorCase{
            "RotationMatrix",
            WithJoints("  - {type: revolute}\n") + "base: {x: 1, roll: 2}\n",
            {6, 14, "base.roll", "expected one of x, y, z, rx"}}),
    CaseName);

bool SameBits(double a, double b) { return std::memcmp(&a, &b, 8) == 0; }

// Doubles of every size and sign, from their bits.
double DrawDouble(Random* random) {
  double value = std::numeric_limits<double>::quiet_NaN();
  while (!std::isfinite(value)) {
    const std::uint64_t bits = random->Next();
    std::memcpy(&value, &bits, sizeof(value));
  }
  return value;
}

void ExpectSameBits(const Joint& a, const Joint& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_TRUE(SameBits(a.beta, b.beta));
  EXPECT_TRUE(SameBits(a.alpha, b.alpha));
  EXPECT_TRUE(SameBits(a.d, b.d));
  EXPECT_TRUE(SameBits(a.theta, b.theta));
  EXPECT_TRUE(SameBits(a.r, b.r));
  EXPECT_TRUE(SameBits(a.lower, b.lower));
  EXPECT_TRUE(SameBits(a.upper, b.upper));
}

TEST(FormatArmTest, ReadsBackToTheSameBits) {
  Random random(1);
  Arm arm;
  arm.name = "test";
  for (int j = 0; j < 64; ++j) {
    Joint joint;
    joint.type = j % 3 == 0 ? JointType::kPrismatic : JointType::kRevolute;
    joint.beta = DrawDouble(&random);
    joint.alpha = DrawDouble(&random);
    joint.d = DrawDouble(&random);
    joint.theta = DrawDouble(&random);
    joint.r = DrawDouble(&random);
    joint.lower = -std::abs(DrawDouble(&random));
    joint.upper = std::abs(DrawDouble(&random));
    arm.joints.push_back(joint);
  }
  arm.joints[1].beta = -0.0;
  arm.joints[2].lower = -kInfinity;
  arm.joints[3].upper = kInfinity;
  arm.joints[4].lower = -kInfinity;
  arm.joints[4].upper = kInfinity;
  arm.instrument_from_base.translation() << 0.1, -0.2, 1.0 / 3.0;

  const Arm read = LoadText(FormatArm(arm, ""));
  ASSERT_EQ(read.num_joints(), arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    ExpectSameBits(read.joints[j], arm.joints[j]);
  }
  EXPECT_EQ(read.instrument_from_base.translation(),
            arm.instrument_from_base.translation());
}

TEST(FormatArmTest, KeepsRotationsToRounding) {
  Random random(2);
  Arm arm;
  arm.name = "test";
  arm.joints.emplace_back();
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector3d rotation;
    for (double& x : rotation) x = random.Uniform(-1.7, 1.7);
    arm.instrument_from_base.linear() = RotationFromVector<double>(rotation);
    arm.last_from_target().linear() =
        RotationFromVector<double>(1e-9 * rotation);
    const Arm read = LoadText(FormatArm(arm, ""));
    // A few roundings of numbers of size one.
    EXPECT_LT(
        (read.instrument_from_base.linear() - arm.instrument_from_base.linear())
            .cwiseAbs()
            .maxCoeff(),
        3e-15);
    EXPECT_LT(
        (read.last_from_target().linear() - arm.last_from_target().linear())
            .cwiseAbs()
            .maxCoeff(),
        1e-15);
  }
}

TEST(FormatArmTest, KeepsAnyName) {
  Arm arm;
  arm.joints.emplace_back();
  for (const char* name :
       {"a: b", "\"quoted\" \\ # no comment", "zwei\nZeilen\t.", "\xc3\xa9",
        "12", "null", " spaces ", "[1, 2]"}) {
    arm.name = name;
    EXPECT_EQ(LoadText(FormatArm(arm, "")).name, name);
  }
}

TEST(FormatArmTest, ShowsPeopleMillimetresAndDegrees) {
  const Arm arm = LoadArm(SourcePath("configs/robots/rv2aj_wrist.yaml"));
  const std::string text = FormatArm(arm, "Made by a test.\n\nTwice.");
  EXPECT_EQ(text.find("# Made by a test.\n#\n# Twice.\nformat: alidade-arm-1"),
            0U);
  EXPECT_NE(text.find("    d: 0.25  # 250 mm\n"), std::string::npos) << text;
  EXPECT_NE(text.find("  # -90 deg\n"), std::string::npos) << text;
  EXPECT_NE(text.find("]  # -60 deg to 120 deg\n"), std::string::npos) << text;
}

TEST(FormatArmTest, CommentCannotBreakOutOfItsLine) {
  Arm arm;
  arm.name = "test";
  arm.joints.emplace_back();
  EXPECT_EQ(LoadText(FormatArm(arm, "a\rname: b\nname: c")).name, "test");
}

TEST(LoadArmTest, ReadsCraigsAAndDAsDAndR) {
  const Arm arm =
      LoadText(std::string(kHeader) +
               "convention: craig\n"
               "joints: [{type: revolute, theta: 1, d: 2, a: 3, alpha: 4}]\n");
  EXPECT_EQ(arm.joints[0].theta, 1 * kDegree);
  EXPECT_EQ(arm.joints[0].r, 0.002);
  EXPECT_EQ(arm.joints[0].d, 0.003);
  EXPECT_EQ(arm.joints[0].alpha, 4 * kDegree);
}

TEST(LoadArmTest, PutsTheLastStandardRowBeforeTheTool) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "convention: standard\n"
                           "joints:\n"
                           "  - {type: revolute, d: 2, a: 3, alpha: 90}\n"
                           "  - {type: revolute, d: 5, a: 7, alpha: -90}\n"
                           "tool: {z: 10}\n");
  EXPECT_EQ(arm.joints[0].d, 0.0);
  EXPECT_EQ(arm.joints[1].d, 0.003);
  EXPECT_EQ(arm.joints[1].alpha, 90 * kDegree);
  EXPECT_EQ(arm.joints[1].r, 0.005);
  // Rot(x, -90 deg) takes z to y.
  const Eigen::Vector3d tool(0.007, 0.01, 0.0);
  EXPECT_LT((arm.last_from_target().translation() - tool).norm(), 1e-15);
}

TEST(LoadArmTest, SignAndOffsetMapMotorsToJoints) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "joints: [{type: revolute, sign: -1, offset: 90}, "
                           "{type: prismatic, offset: 5}]\n");
  const Eigen::Vector2d motors(0.5, 0.1);
  const Eigen::VectorXd q = JointsFromMotors(arm, motors);
  EXPECT_EQ(q[0], 90 * kDegree - 0.5);
  EXPECT_NEAR(q[1], 0.105, 1e-15);
  EXPECT_LT((MotorsFromJoints(arm, q) - motors).norm(), 1e-15);
}

TEST(LoadArmTest, ReadsUrdfBetweenBaseAndTool) {
  const TestDirectory directory;
  directory.Write("arm.urdf",
                  "<robot><link name='a'/><link name='b'/>"
                  "<joint name='j' type='continuous'><parent link='a'/>"
                  "<child link='b'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/>"
                  "</joint></robot>");
  const Arm arm = LoadArm(directory.Write(
      "arm.yaml", std::string(kHeader) +
                      "urdf: {file: arm.urdf, base_link: a, tip_link: b}\n"
                      "base: {x: 5}\ntool: {y: 7}\n"));
  ASSERT_EQ(arm.num_joints(), 1);
  EXPECT_EQ(arm.joints[0].r, 1.0);
  EXPECT_EQ(arm.instrument_from_base.translation().x(), 0.005);
  EXPECT_EQ(arm.last_from_target().translation().y(), 0.007);
}

TEST(LoadArmTest, ReadsSeveralTargets) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "convention: standard\n"
                           "joints: [{type: revolute, a: 3}]\n"
                           "targets: [{name: ball, z: 10}, "
                           "{name: probe, x: 1, rz: 90}]\n");
  ASSERT_EQ(arm.num_targets(), 2);
  EXPECT_EQ(arm.targets[0].name, "ball");
  EXPECT_EQ(arm.last_from_target(0).translation(),
            Eigen::Vector3d(0.003, 0.0, 0.01));
  EXPECT_EQ(arm.targets[1].name, "probe");
  EXPECT_EQ(arm.last_from_target(1).translation(),
            Eigen::Vector3d(0.004, 0.0, 0.0));
  EXPECT_NEAR(arm.last_from_target(1).linear()(1, 0), 1.0, 1e-15);
}

TEST(FormatArmTest, KeepsTargetsToTheBit) {
  Random random(3);
  Arm arm;
  arm.name = "test";
  arm.joints.emplace_back();
  arm.targets.clear();
  for (const char* name : {"a: \"b\"", "probe", "12"}) {
    Target target;
    target.name = name;
    for (double& x : target.last_from_target.translation()) {
      x = random.Normal();
    }
    arm.targets.push_back(target);
  }
  const std::string text = FormatArm(arm, "");
  const Arm read = LoadText(text);
  ASSERT_EQ(read.num_targets(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(read.targets[i].name, arm.targets[i].name);
    EXPECT_EQ(read.last_from_target(i).matrix(),
              arm.last_from_target(i).matrix());
  }
  EXPECT_EQ(FormatArm(read, ""), text);
  arm.targets.resize(1);
  EXPECT_EQ(LoadText(FormatArm(arm, "")).targets[0].name, arm.targets[0].name);
}

const char kUrdf[] =
    "<robot><link name='a'/><link name='b'/>\n"
    "<joint name='j' type='revolute'><parent link='a'/><child link='b'/>"
    "<axis xyz='0 0 1'/>\n"
    "<limit lower='-1' upper='2'/></joint></robot>";

TEST(LoadArmTest, NamesTheUrdfThatItRead) {
  const TestDirectory directory;
  directory.Write("arm.urdf", kUrdf);
  const std::string path = directory.Write(
      "arm.yaml", std::string(kHeader) +
                      "urdf: {file: arm.urdf, base_link: a, tip_link: b}\n");
  std::vector<std::string> files;
  LoadArm(path, &files);
  EXPECT_EQ(files, std::vector<std::string>{directory.Path("arm.urdf")});
}

TEST(LoadArmTest, ErrorsInAUrdfNameTheArmFile) {
  const TestDirectory directory;
  std::string urdf = kUrdf;
  urdf.replace(urdf.find("lower='-1'"), 10, "lower='3'");
  directory.Write("arm.urdf", urdf);
  const std::string text =
      std::string(kHeader) +
      "urdf: {file: arm.urdf, base_link: a, tip_link: b}\n";
  const std::string path = directory.Write("arm.yaml", text);
  ExpectInputError([&] { LoadArm(path); },
                   {3, 0, "",
                    "joint \"j\" has the lower limit 3 above the upper one 2, "
                    "expected lower <= upper (named in " +
                        path + ":4: urdf.file)"});
  std::string missing = text;
  missing.replace(missing.find("arm.urdf"), 8, "no.urdf");
  directory.Write("arm.yaml", missing);
  ExpectInputError([&] { LoadArm(path); },
                   {4, 14, "urdf.file", "no.urdf: cannot be read"});
}

TEST(FormatArmTest, KeepsTheMotorMap) {
  const Arm arm = LoadText(std::string(kHeader) +
                           "joints: [{type: revolute}, {type: revolute}, "
                           "{type: prismatic}]\n"
                           "motors: {matrix: [[1, 0, 0], [-1, 1, 0], "
                           "[2, 0, 1]], offset: [90, 0, 5]}\n");
  // 2 mm per degree.
  EXPECT_NEAR(arm.joints_from_motors(2, 0), 2e-3 / kDegree, 1e-15);
  EXPECT_EQ(arm.joints_from_motors(1, 0), -1.0);
  EXPECT_EQ(arm.motor_offsets[2], 0.005);
  const Arm read = LoadText(FormatArm(arm, ""));
  EXPECT_EQ(read.joints_from_motors, arm.joints_from_motors);
  EXPECT_EQ(read.motor_offsets, arm.motor_offsets);
}

}  // namespace
}  // namespace alidade::internal::arm_file_test
