#include "src/dataio/urdf_file.h"

#include <gtest/gtest.h>

#include "tests/support/io_test_util.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::urdf_file_test {
namespace {

std::vector<ChainJoint> Load(const std::string& joint,
                             const std::string& base = "a") {
  const TestDirectory directory;
  return LoadUrdfChain(
      directory.Write("arm.urdf",
                      "<robot name='r'><link name='a'/><link name='b'/>"
                      "<link name='c'/>\n" +
                          joint + "</robot>"),
      base, "b");
}

const char kEnds[] = "<parent link='a'/><child link='b'/>";

TEST(LoadUrdfChainTest, HonoursOriginAxisAndLimits) {
  const auto chain =
      Load("<joint name='j' type='revolute'>" + std::string(kEnds) +
           "<origin xyz='1 2 3' rpy='0.1 0.2 0.3'/>"
           "<axis xyz='0 0 -1'/>"
           "<limit lower='-1' upper='2'/></joint>");
  ASSERT_EQ(chain.size(), 1U);
  EXPECT_EQ(chain[0].upper, 2.0);
  using namespace testing;
  const Matrix4l expected = Translation({1, 2, 3}) * RotationZ(0.3) *
                            RotationY(0.2) * RotationX(0.1) * RotationZ(-0.7);
  const double q = 0.7;
  const Matrix4l frame = MatrixTargetFrame(ArmFromChain(chain), &q);
  EXPECT_LT((frame - expected).cwiseAbs().maxCoeff(), 1e-12L);
}

constexpr char kArmText[] =
    "<link name='a'/><link name='b'/><link name='c'/><link name='d'/>"
    "<joint name='j1' type='revolute'><parent link='a'/><child link='b'/>"
    "<origin xyz='0 0 0.3'/><axis xyz='0 0 1'/></joint>"
    "<joint name='j2' type='revolute'><parent link='b'/><child link='c'/>"
    "<origin xyz='0.1 0 0.2' ROTATION/><axis xyz='0 0 1'/></joint>"
    "<joint name='j2b' type='revolute'><parent link='c'/><child link='d'/>"
    "<origin xyz='0.05 0 0' rpy='0 0.7 0'/><axis xyz='0 0 1'/>"
    "MIMIC</joint>";

// The arm with a second joint that is turned, and a third that may follow it.
Arm ThreeAxes(const std::string& rotation, const std::string& mimic,
              const std::string& before = "") {
  std::string text = kArmText;
  text.replace(text.find("ROTATION"), 8, rotation);
  text.replace(text.find("MIMIC"), 5, mimic);
  const TestDirectory directory;
  return LoadUrdfArm(directory.Write("arm.urdf", "<robot name='r'>" + before +
                                                     text + "</robot>"),
                     "a", "d");
}

// By matrices, from the text alone.
testing::Matrix4l FrameOf(double q1, double q2, double q2b) {
  using namespace testing;
  return Translation({0, 0, 0.3}) * RotationZ(q1) * Translation({0.1, 0, 0.2}) *
         RotationX(kPi / 2.0) * RotationZ(q2) * Translation({0.05, 0, 0}) *
         RotationY(0.7) * RotationZ(q2b);
}

void ExpectFrame(const Arm& arm, const Eigen::VectorXd& motors,
                 const testing::Matrix4l& expected) {
  const Eigen::VectorXd q = JointsFromMotors(arm, motors);
  const testing::Matrix4l frame = testing::MatrixTargetFrame(arm, q.data());
  EXPECT_LT((frame - expected).cwiseAbs().maxCoeff(), 1e-9L);
}

TEST(LoadUrdfArmTest, ReadsWhatPublicFilesHold) {
  const Eigen::Vector3d q(0.4, -0.9, 1.3);
  for (const std::string rotation :
       {"rpy='1.5707963267948966 0 0'", "rpy=' +1.5707963267948966\t0   0 '",
        "quat_xyzw='0.7071067811865476 0 0 0.7071067811865476'"}) {
    SCOPED_TRACE(rotation);
    ExpectFrame(ThreeAxes(rotation, ""), q, FrameOf(q[0], q[1], q[2]));
  }
  // Words of xacro in comments and texts mean nothing.
  const Arm arm =
      ThreeAxes("rpy='1.5707963267948966 0 0'", "",
                "<!-- <xacro:include filename='old'/> -->"
                "<gazebo><note>see &lt;xacro:arm&gt;</note></gazebo>");
  ExpectFrame(arm, q, FrameOf(q[0], q[1], q[2]));
}

TEST(LoadUrdfArmTest, JointsThatMimicFollowTheirMotors) {
  const Arm arm =
      ThreeAxes("rpy='1.5707963267948966 0 0'",
                "<mimic joint='j2' multiplier='-1.5' offset='0.25'/>");
  ASSERT_EQ(arm.joints_from_motors.rows(), 3);
  ASSERT_EQ(arm.joints_from_motors.cols(), 2);
  const Eigen::Vector2d motors(0.4, -0.9);
  ExpectFrame(arm, motors, FrameOf(0.4, -0.9, -1.5 * -0.9 + 0.25));
  // And back.
  const Eigen::VectorXd again =
      MotorsFromJoints(arm, JointsFromMotors(arm, motors));
  EXPECT_LT((again - motors).norm(), 1e-12);
}

TEST(LoadUrdfArmTest, RefusesWhatItWouldMiss) {
  const std::string rotation = "rpy='1.5707963267948966 0 0'";
  const auto expect = [](const std::string& of, const std::string& mimic,
                         const std::string& message) {
    ExpectInputError([&] { ThreeAxes(of, mimic); }, {1, 0, "", message});
  };
  expect("rpx='1 0 0'", "", "unknown attribute \"rpx\", did you mean \"rpy\"");
  expect("quat_xyzw='1 1 0 0'", "", "expected a unit quaternion");
  expect("rpy='0 0 0' quat_xyzw='0 0 0 1'", "", "expected one of both");
  expect("rpy='${pi/2} 0 0'", "", "an expression of xacro");
  expect(rotation, "<mimic joint='j3'/>", "\"j3\", which is not there");
  expect(rotation, "<mimic joint='j2b'/>", "which mimics it");
  const TestDirectory directory;
  const std::string path = directory.Write(
      "macro.urdf",
      "<robot><xacro:macro name='arm'><link name='a'/></xacro:macro></robot>");
  ExpectInputError([&] { LoadUrdfArm(path, "a", "d"); },
                   {1, 0, "", "holds only a xacro macro"});
}

TEST(LoadUrdfArmTest, HasAtMostAsManyJointsAsAnArmFile) {
  std::string text = "<robot><link name='l0'/>";
  for (int i = 1; i <= 65; ++i) {
    const std::string number = std::to_string(i);
    text += "<link name='l" + number + "'/><joint name='j" + number +
            "' type='revolute'><parent link='l" + std::to_string(i - 1) +
            "'/><child link='l" + number + "'/><axis xyz='0 0 1'/></joint>";
  }
  const TestDirectory directory;
  const std::string path = directory.Write("r.urdf", text + "</robot>");
  ExpectInputError([&] { LoadUrdfArm(path, "l0", "l65"); },
                   {0, 0, "", "65 joints move between the links"});
  EXPECT_EQ(LoadUrdfArm(path, "l0", "l64").num_joints(), 64);
}

TEST(LoadUrdfArmTest, AxesOfAnyLengthAreDirections) {
  for (const std::string axis : {"0 1e300 1e300", "0 1e-200 1e-200", "0 1 1"}) {
    const auto chain =
        Load("<joint name='j' type='revolute'>" + std::string(kEnds) +
             "<axis xyz='" + axis + "'/></joint>");
    EXPECT_NEAR(chain[0].axis.y(), std::sqrt(0.5), 1e-12) << axis;
    EXPECT_NEAR(chain[0].axis.z(), std::sqrt(0.5), 1e-12) << axis;
  }
}

TEST(LoadUrdfChainTest, SaysWhatIsWrong) {
  const std::string ends = kEnds;
  const auto expect = [](const std::string& joint, int line,
                         const std::string& message) {
    ExpectInputError([&] { Load(joint); }, {line, 0, "", message});
  };
  expect("<joint name='j' type='planar'>" + ends + "</joint>", 2, "planar");
  expect(
      "<joint name='j' type='revolute'>" + ends + "<axis xyz='0 0 0'/></joint>",
      2, "zero axis");
  expect("<joint name='j' type='prismatic'>" + ends +
             "\n<limit lower='2' upper='1'/></joint>",
         3, "lower limit 2 above the upper one 1");
  expect("", 1, "no chain from link");
  expect("<xacro:arm/>", 2, "expand it first");
  ExpectInputError([] { Load("", "d"); }, {1, 0, "", "unknown link"});
}

}  // namespace
}  // namespace alidade::internal::urdf_file_test
