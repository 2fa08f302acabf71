#ifndef ALIDADE_TESTS_INITIALIZATION_FRAME_START_UTIL_H_
#define ALIDADE_TESTS_INITIALIZATION_FRAME_START_UTIL_H_

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/rotation.h"
#include "src/common/random.h"
#include "tests/support/random_arms.h"

namespace alidade::internal::testing {

using Poses = std::vector<Eigen::Isometry3d>;

// The prior moves targets by some 1e-11 m where the fit is exact.
inline constexpr double kExact = 1e-8;

inline Eigen::Vector3d NormalVector(double stddev, Random* random) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = stddev * random->Normal();
  return vector;
}

// A six-axis arm of 0.9 m with joints within +- 100 degrees.
inline Poses RandomFlangePoses(int num_poses, Random* random) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Poses poses;
  for (int i = 0; i < num_poses; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const auto turn = [&](const Eigen::Vector3d& axis) {
      pose.rotate(Eigen::AngleAxisd(random->Uniform(-1.75, 1.75), axis));
    };
    turn(z);
    turn(y);
    pose.translate(0.4 * z);
    turn(y);
    pose.translate(0.4 * z);
    turn(z);
    turn(y);
    pose.translate(0.1 * z);
    turn(z);
    poses.push_back(pose);
  }
  return poses;
}

// Flange poses whose orientations are all alike.
inline Poses ParallelFlangePoses(int num_poses, Random* random) {
  const Eigen::Isometry3d frame = RandomFrame(0.0, random);
  Poses poses(num_poses, frame);
  for (auto& pose : poses) pose.translation() = RandomVector(0.5, random);
  return poses;
}

// As an arm that differs from its nominal by some mm and mrad.
inline Poses Disturbed(Poses poses, Random* random) {
  for (auto& pose : poses) {
    pose.translation() += NormalVector(0.003, random);
    pose.linear() =
        RotationFromVector<double>(NormalVector(0.005, random)) * pose.linear();
  }
  return poses;
}

inline double TurnBetween(const Eigen::Isometry3d& one,
                          const Eigen::Isometry3d& two) {
  return VectorFromRotation(one.linear().transpose() * two.linear()).norm();
}

inline void ExpectSameFrame(const Eigen::Isometry3d& found,
                            const Eigen::Isometry3d& truth, double metres,
                            double radians) {
  EXPECT_NEAR((found.translation() - truth.translation()).norm(), 0.0, metres);
  EXPECT_NEAR(TurnBetween(found, truth), 0.0, radians);
  EXPECT_NEAR(found.linear().determinant(), 1.0, 1e-12);
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_INITIALIZATION_FRAME_START_UTIL_H_
