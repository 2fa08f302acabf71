#include "src/calibration/orientation_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"
#include "src/common/random.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "tests/support/classic_arms.h"

namespace alidade::internal::orientation_check_test {
namespace {

using ::testing::HasSubstr;

constexpr double kSigma = 5e-5;

// Angles about x, y, z one after the other, read as if about z, y, x.
Eigen::Matrix3d Misread(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d angles = rotation.eulerAngles(0, 1, 2);
  const auto about = [&](int k) {
    return Eigen::AngleAxisd(angles[k], Eigen::Vector3d::Unit(k));
  };
  return (about(2) * about(1) * about(0)).toRotationMatrix();
}

// A UR10 near one posture, so that the two readings differ little enough for
// base and target to hide most of it.
JobConfig PoseJob(bool is_misread, double reach_of_joints,
                  double angle_sigma = 1e-4) {
  constexpr int kPoses = 60;
  JobConfig job;
  job.arm = testing::Ur10();
  for (Joint& joint : job.arm.joints) {
    joint.lower = -reach_of_joints;
    joint.upper = reach_of_joints;
  }
  Random random(3);
  Arm real = job.arm;
  for (Joint& joint : real.joints) {
    joint.theta += random.Uniform(-2e-3, 2e-3);
    joint.d += random.Uniform(-5e-4, 5e-4);
  }
  // The tool's axes are near the instrument's.
  real.last_from_target().linear() =
      TargetPose(real, Eigen::VectorXd::Zero(6)).linear().transpose();
  const Eigen::MatrixXd q = DrawJointValues(real, kPoses, 4);
  Eigen::MatrixXd measured(6, kPoses);
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Isometry3d pose = TargetPose(real, q.col(i));
    const auto noise = [&](double sigma) {
      const double x = random.Normal();
      const double y = random.Normal();
      return Eigen::Vector3d(sigma * Eigen::Vector3d(x, y, random.Normal()));
    };
    measured.col(i).head<3>() = pose.translation() + noise(kSigma);
    const Eigen::Matrix3d turned =
        RotationFromVector<double>(noise(angle_sigma)) * pose.linear();
    measured.col(i).tail<3>() =
        VectorFromRotation(is_misread ? Misread(turned) : turned);
  }
  Eigen::MatrixXd sigmas(6, kPoses);
  sigmas.topRows(3).setConstant(kSigma);
  sigmas.bottomRows(3).setConstant(angle_sigma);
  Dataset& data = job.data.training;
  data = MakePositions(q, measured.topRows(3).eval(), kSigma);
  data.name = "poses";
  data.blocks[0].kind = MeasurementKind::kPose;
  data.blocks[0].measured = measured;
  data.blocks[0].sigmas = sigmas;
  job.options.identifiability.candidates = {true, true, true};
  return job;
}

std::string RefusalOf(const JobConfig& job) {
  try {
    RunJob(job, "test");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OrientationCheckTest, ReadRightTheyPass) {
  for (const double reach : {0.6, 1.5}) {
    EXPECT_EQ(RefusalOf(PoseJob(false, reach)), "") << reach;
  }
}

// A camera's that are good to 2 degrees, stated so or not.
TEST(OrientationCheckTest, NoisyOnesPass) {
  JobConfig job = PoseJob(false, 1.5, 0.035);
  EXPECT_EQ(RefusalOf(job), "");
  job.options.estimate_sigma = true;
  EXPECT_EQ(RefusalOf(job), "");
}

TEST(OrientationCheckTest, MisreadByDegreesTheyAreRefused) {
  EXPECT_THAT(RefusalOf(PoseJob(true, 0.6)), HasSubstr("no arm does that"));
}

TEST(OrientationCheckTest, MisreadByFarTheyAreRefusedBefore) {
  EXPECT_THAT(RefusalOf(PoseJob(true, 1.5)), HasSubstr("whatever its base"));
}

TEST(OrientationCheckTest, WithEstimatedSigmasAsWell) {
  JobConfig job = PoseJob(true, 0.6);
  job.options.estimate_sigma = true;
  EXPECT_THAT(RefusalOf(job), HasSubstr("no arm does that"));
}

}  // namespace
}  // namespace alidade::internal::orientation_check_test
