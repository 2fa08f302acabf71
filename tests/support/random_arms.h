#ifndef ALIDADE_TESTS_SUPPORT_RANDOM_ARMS_H_
#define ALIDADE_TESTS_SUPPORT_RANDOM_ARMS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

#include "alidade/arm.h"
#include "alidade/units.h"
#include "src/common/random.h"

namespace alidade::internal::testing {

/// Uniform in the cube [-size, size)^3.
Eigen::Vector3d RandomVector(double size, Random* random);

/// Uniform on the unit sphere.
Eigen::Vector3d RandomDirection(Random* random);

/// Any rotation, and a translation in the cube [-size, size)^3 (m).
Eigen::Isometry3d RandomFrame(double size, Random* random);

struct RandomArmOptions {
  double prismatic_fraction = 0.3;  ///< chance of a joint to be prismatic
  bool with_frames = true;          ///< false: base and tool are identities
  int num_targets = 1;
};

/// An arm with generic parameters: no two axes parallel or intersecting, no
/// value zero. Revolute joints turn by +-180 deg, prismatic ones travel by
/// +-0.3 m. The same engine state gives the same arm.
Arm RandomArm(int num_joints, Random* random,
              const RandomArmOptions& options = {});

/// Joint values uniform within the limits, n x num_poses.
/// @pre every limit is finite.
Eigen::MatrixXd RandomJointValues(const Arm& arm, int num_poses,
                                  Random* random);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_RANDOM_ARMS_H_
