#include "src/dataio/urdf_file.h"

#include <gtest/gtest.h>

#include "tests/support/io_test_util.h"
#include "tests/support/matrix_kinematics.h"

namespace alidade::internal {
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
  expect(
      "<joint name='j' type='revolute'>" + ends + "<mimic joint='k'/></joint>",
      2, "mimics");
  expect("<joint name='j' type='prismatic'>" + ends +
             "\n<limit lower='2' upper='1'/></joint>",
         3, "lower limit 2 above the upper one 1");
  expect("", 1, "no chain from link");
  expect("<xacro:arm/>", 1, "expand it first");
  ExpectInputError([] { Load("", "d"); }, {1, 0, "", "unknown link"});
}

}  // namespace
}  // namespace alidade::internal
