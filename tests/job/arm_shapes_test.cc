#include "src/job/arm_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/common/files.h"
#include "tests/support/process.h"

namespace alidade::internal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// Two joints askew; a triangle hangs on the base and on the last link, in mm
// and moved by an origin of its own.
constexpr char kUrdf[] = R"(<robot name="askew">
  <link name="base"><visual><geometry>
    <mesh filename="package://askew/meshes/tri.stl"/></geometry></visual></link>
  <link name="arm"><visual><geometry>
    <mesh filename="package://askew/meshes/arm.dae"/></geometry></visual></link>
  <link name="hand"><visual><geometry><mesh filename="meshes/none.stl"/>
    </geometry></visual><collision>
    <origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/><geometry>
    <mesh filename="package://askew/meshes/tri.obj" scale="0.001 0.001 0.001"/>
    </geometry></collision></link>
  <joint name="a" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0.1 0 0.4" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="b" type="revolute"><parent link="arm"/><child link="hand"/>
    <origin xyz="0.5 0.02 0.1" rpy="-0.4 0.7 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>
)";

Isometry3d Pose(double x, double y, double z, double roll, double pitch,
                double yaw) {
  return Isometry3d(Translation3d(x, y, z)) *
         AngleAxisd(yaw, Vector3d::UnitZ()) *
         AngleAxisd(pitch, Vector3d::UnitY()) *
         AngleAxisd(roll, Vector3d::UnitX());
}

class ArmShapesTest : public ::testing::Test {
 protected:
  ArmShapesTest() {
    const std::string triangle = "v 100 0 0\nv 0 200 0\nv 0 0 300\nf 1 2 3\n";
    testing::WriteWhole(directory_ / "askew/meshes/tri.obj", triangle);
    testing::WriteWhole(directory_ / "askew/meshes/tri.stl",
                        "solid t\nfacet\nvertex 0.1 0 0\nvertex 0 0.2 0\n"
                        "vertex 0 0 0.3\nendfacet\nendsolid t\n");
    testing::WriteWhole(directory_ / "askew/meshes/arm.dae", "<COLLADA/>");
    testing::WriteWhole(directory_ / "askew/urdf/askew.urdf", kUrdf);
    testing::WriteWhole(directory_ / "arm.yaml",
                        "format: alidade-arm-1\nname: askew\n"
                        "units: {length: mm, angle: deg}\n"
                        "urdf: {file: askew/urdf/askew.urdf, base_link: base, "
                        "tip_link: hand}\n");
    for (const char* name : {"arm.yaml", "askew/urdf/askew.urdf"}) {
      const std::string path = directory_ / name;
      inputs_.push_back({path, Sha256OfFile(path)});
    }
    arm_ = LoadArm(inputs_[0].path);
  }

  // Of the URDF; the inputs are what they then are.
  void Rewrite(const std::string& old_text, const std::string& new_text) {
    std::string urdf = ReadFile(inputs_[1].path);
    const std::size_t at = urdf.find(old_text);
    ASSERT_NE(at, std::string::npos) << old_text;
    testing::WriteWhole(inputs_[1].path,
                        urdf.replace(at, old_text.size(), new_text));
    for (InputFile& input : inputs_) input.sha256 = Sha256OfFile(input.path);
  }

  testing::TemporaryDirectory directory_;
  std::vector<InputFile> inputs_;
  Arm arm_;
};

// Where the links are by the chain of the URDF, multiplied by hand.
TEST_F(ArmShapesTest, LinksMoveAsTheUrdfSays) {
  const ArmShapes shapes = ShapesOf(inputs_, arm_);
  ASSERT_THAT(shapes.links, SizeIs(2));
  EXPECT_EQ(shapes.links[0].frame, 0);
  EXPECT_EQ(shapes.links[1].frame, 2);
  const Eigen::Vector2d joints(0.7, -1.1);
  const std::vector<Isometry3d> frames = LinkFrames(arm_, joints);
  ASSERT_THAT(frames, SizeIs(3));
  const Isometry3d hand = Pose(0.1, 0.0, 0.4, 0.1, 0.2, 0.3) *
                          AngleAxisd(joints[0], Vector3d::UnitZ()) *
                          Pose(0.5, 0.02, 0.1, -0.4, 0.7, 0.2) *
                          AngleAxisd(joints[1], Vector3d::UnitY()) *
                          Pose(0.1, 0.2, 0.3, 0.3, 0.2, 0.1);
  const Eigen::Matrix3d corners = Vector3d(0.1, 0.2, 0.3).asDiagonal();
  const auto drawn = [&](const LinkShape& shape) -> Eigen::Matrix3Xd {
    return frames[static_cast<std::size_t>(shape.frame)] *
           (shape.vertices * kMillimetre);
  };
  // The mesh's files hold single precision.
  constexpr double kRounding = 1e-7;
  EXPECT_TRUE(drawn(shapes.links[0]).isApprox(corners, kRounding));
  EXPECT_TRUE(
      drawn(shapes.links[1]).isApprox((hand * corners).eval(), kRounding));
}

// The same turn as roll, pitch and yaw of 0.3, 0.2 and 0.1, by Eigen.
TEST_F(ArmShapesTest, OriginsMayBeQuaternions) {
  const ArmShapes before = ShapesOf(inputs_, arm_);
  const Eigen::Quaterniond turn(Pose(0, 0, 0, 0.3, 0.2, 0.1).linear());
  std::string quaternion = "quat_xyzw=\"";
  for (const double number : {turn.x(), turn.y(), turn.z(), turn.w()}) {
    quaternion += std::to_string(number) + " ";
  }
  Rewrite("rpy=\"0.3 0.2 0.1\"", quaternion + "\"");
  const ArmShapes shapes = ShapesOf(inputs_, arm_);
  ASSERT_THAT(shapes.links, SizeIs(2));
  constexpr double kSixDecimals = 1e-5;
  EXPECT_TRUE(shapes.links[1].vertices.isApprox(before.links[1].vertices,
                                                kSixDecimals));
}

TEST_F(ArmShapesTest, UnreadableOriginsAreSaid) {
  Rewrite("xyz=\"0.1 0.2 0.3\"", "xyz=\"0.1 much 0.3\"");
  EXPECT_THAT(ShapesOf(inputs_, arm_).note,
              HasSubstr("expected 3 numbers as xyz, found \"0.1 much 0.3\""));
}

// A page is sent to others: a URDF that came from others does not choose which
// files are in it.
TEST_F(ArmShapesTest, FilesOutsideOfThePackageStayWhereTheyAre) {
  testing::WriteWhole(directory_ / "secret.stl",
                      ReadFile(directory_ / "askew/meshes/tri.stl"));
  std::filesystem::create_directories(directory_ / "deep/a/b/c/d");
  std::filesystem::rename(directory_ / "askew",
                          directory_ / "deep/a/b/c/askew");
  testing::WriteWhole(directory_ / "arm.yaml",
                      "format: alidade-arm-1\nname: askew\n"
                      "units: {length: mm, angle: deg}\n"
                      "urdf: {file: deep/a/b/c/askew/urdf/askew.urdf, "
                      "base_link: base, tip_link: hand}\n");
  inputs_[1].path = directory_ / "deep/a/b/c/askew/urdf/askew.urdf";
  const std::string mesh = "package://askew/meshes/tri.stl";
  Rewrite(mesh, mesh);
  EXPECT_THAT(ShapesOf(inputs_, arm_).links, SizeIs(2));
  std::string now = mesh;
  for (const std::string& other :
       {"file://" + std::string(directory_ / "secret.stl"),
        std::string(directory_ / "secret.stl"),
        std::string("../../../../../../secret.stl"),
        std::string("package://askew/../../../../../secret.stl")}) {
    Rewrite(now, other);
    now = other;
    const ArmShapes shapes = ShapesOf(inputs_, arm_);
    EXPECT_THAT(shapes.links, SizeIs(1)) << other;
    EXPECT_THAT(shapes.note, HasSubstr("is not there")) << other;
  }
}

TEST_F(ArmShapesTest, WhatIsMissingIsSaid) {
  EXPECT_THAT(ShapesOf(inputs_, arm_).note,
              HasSubstr("Links without a shape: arm (expected an STL or OBJ "
                        "file)."));
  testing::WriteWhole(directory_ / "askew/meshes/tri.obj", "f 1 2 3\n");
  const ArmShapes shapes = ShapesOf(inputs_, arm_);
  EXPECT_THAT(shapes.links, SizeIs(1));
  EXPECT_THAT(shapes.note, HasSubstr("hand (has a face with a corner"));
}

TEST_F(ArmShapesTest, OtherFilesHaveNoShape) {
  EXPECT_THAT(ShapesOf({}, arm_).links, SizeIs(0));
  std::vector<InputFile> changed = inputs_;
  changed[1].sha256 = "another file";
  EXPECT_THAT(ShapesOf(changed, arm_).links, SizeIs(0));
  Arm longer = arm_;
  longer.joints.push_back(longer.joints.back());
  EXPECT_THAT(ShapesOf(inputs_, longer).links, SizeIs(0));
  inputs_.insert(inputs_.begin(), {"/dev/null", ""});
  EXPECT_THAT(ShapesOf(inputs_, arm_).links, SizeIs(2));
}

}  // namespace
}  // namespace alidade::internal
