// Data that other programs wrote, as jobs name them, and arms with fewer motors
// than joints.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "alidade/arm_file.h"
#include "alidade/units.h"
#include "src/serialization/job_config.h"
#include "tests/support/io_test_util.h"

namespace alidade::internal::foreign_data_test {
namespace {

const char kHeader[] =
    "format: alidade-arm-1\n"
    "name: test\n"
    "units: {length: mm, angle: deg}\n";

// A job on an arm of a turning and a sliding joint.
std::string WriteJob(const TestDirectory& directory, const std::string& data) {
  directory.Write("arm.yaml", std::string(kHeader) +
                                  "joints: [{type: revolute}, {type: "
                                  "prismatic, alpha: 90}]\n");
  return directory.Write("job.yaml",
                         "format: alidade-job-1\n"
                         "title: A test\n"
                         "units: {length: mm, angle: deg}\n"
                         "arm: arm.yaml\n"
                         "measurement: {sigma: 0.02}\n" +
                             data);
}

Arm LoadText(const std::string& text) {
  const TestDirectory directory;
  return LoadArm(directory.Write("arm.yaml", text));
}

TEST(LoadJobTest, ForeignHeadersWithoutUnitsHaveThoseThatAreStated) {
  const TestDirectory directory;
  directory.Write("foreign.csv", "axis,lift,X,Y,Z\n90,2,3,4,5\n");
  const auto joints = [&](const std::string& unit) {
    const std::string job = WriteJob(
        directory,
        "data: {file: foreign.csv, columns: {joints: [axis, lift], position: "
        "[X, Y, Z]" +
            unit + "}}\n");
    return LoadJob(job).data.training.joint_values.map().col(0).eval();
  };
  // Those of the job: mm and deg.
  EXPECT_NEAR(joints("")[0], 0.5 * kPi, 1e-15);
  EXPECT_NEAR(joints("")[1], 0.002, 1e-15);
  EXPECT_NEAR(joints(", unit: [rad, m]")[0], 90.0, 1e-12);
  EXPECT_NEAR(joints(", unit: [rad, m]")[1], 2.0, 1e-15);
  EXPECT_NEAR(joints(", unit: in")[1], 0.0508, 1e-15);
}

TEST(LoadJobTest, LeavesOutRowsByLinesAndConditions) {
  const TestDirectory directory;
  directory.Write("foreign.csv",
                  "q1_deg;q2_mm;x_mm;y_mm;z_mm;state\n"
                  "1;2;3,5;4;5;ok\n2;2;3,5;4;5;lost\n3;2;3,5;4;5;ok\n"
                  "4;2;9,5;4;5;ok\n5;2;3,5;4;-99;ok\nMean;2;3;4;5;\n");
  const std::string job = WriteJob(
      directory,
      "data: {file: foreign.csv, columns: {}, missing: [-99], exclude: [4, "
      "7-9, state = lost, x_mm > 9]}\n");
  const JobConfig config = LoadJob(job);
  const Dataset& data = config.data.training;
  ASSERT_EQ(data.num_poses(), 2);
  EXPECT_NEAR(data.joint_values(0, 0), 1.0 * kDegree, 1e-15);
  EXPECT_NEAR(data.joint_values(0, 1), 5.0 * kDegree, 1e-15);
  EXPECT_NEAR(data.blocks[0].measured(0, 0), 0.0035, 1e-15);
  EXPECT_TRUE(std::isinf(data.blocks[0].sigmas(2, 1)));
}

TEST(LoadArmTest, JointsMayOutnumberMotors) {
  const std::string joints =
      "joints: [{type: prismatic}, {type: revolute}, {type: revolute}]\n";
  const Arm arm = LoadText(std::string(kHeader) + joints +
                           "motors: {matrix: [[1, 0], [0, 1], [0.5, -1]], "
                           "offset: [0, 0, 90]}\n");
  const Eigen::Vector2d motors(0.1, 0.3);
  // Half a degree per mm.
  const Eigen::Vector3d expected(0.1, 0.3,
                                 50.0 * kDegree - 0.3 + 90.0 * kDegree);
  const Eigen::VectorXd q = JointsFromMotors(arm, motors);
  EXPECT_LT((q - expected).norm(), 1e-14);
  EXPECT_LT((MotorsFromJoints(arm, q) - motors).norm(), 1e-14);
  const Arm read = LoadText(FormatArm(arm, ""));
  EXPECT_EQ(read.joints_from_motors, arm.joints_from_motors);
  // Two motors that do the same.
  const TestDirectory directory;
  const std::string path = directory.Write(
      "arm.yaml", std::string(kHeader) + joints +
                      "motors: {matrix: [[1, 2], [2, 4], [3, 6]]}\n");
  ExpectInputError([&] { LoadArm(path); },
                   {5, 18, "motors.matrix", "independently of each other"});
}

}  // namespace
}  // namespace alidade::internal::foreign_data_test
