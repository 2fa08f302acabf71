#include "tests/support/random_arms.h"

namespace alidade::internal::testing {

Eigen::Vector3d RandomVector(double size, Random* random) {
  const double x = random->Uniform(-size, size);
  const double y = random->Uniform(-size, size);
  const double z = random->Uniform(-size, size);
  return {x, y, z};
}

Eigen::Vector3d RandomDirection(Random* random) {
  const double x = random->Normal();
  const double y = random->Normal();
  const double z = random->Normal();
  return Eigen::Vector3d(x, y, z).normalized();
}

Eigen::Isometry3d RandomFrame(double size, Random* random) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis = RandomDirection(random);
  const double angle = random->Uniform(-kPi, kPi);
  frame.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  frame.translation() = RandomVector(size, random);
  return frame;
}

Arm RandomArm(int num_joints, Random* random, const RandomArmOptions& options) {
  Arm arm;
  arm.name = "random" + std::to_string(num_joints);
  for (int j = 0; j < num_joints; ++j) {
    Joint joint;
    const bool prismatic = random->Uniform() < options.prismatic_fraction;
    joint.type = prismatic ? JointType::kPrismatic : JointType::kRevolute;
    joint.beta = random->Uniform(-kPi, kPi);
    joint.alpha = random->Uniform(-kPi, kPi);
    joint.d = random->Uniform(-0.5, 0.5);
    joint.theta = random->Uniform(-kPi, kPi);
    joint.r = random->Uniform(-0.5, 0.5);
    joint.upper = prismatic ? 0.3 : kPi;
    joint.lower = -joint.upper;
    arm.joints.push_back(joint);
  }
  if (options.with_frames) {
    arm.instrument_from_base = RandomFrame(1.0, random);
    arm.last_from_target() = RandomFrame(0.2, random);
  }
  for (int target = 1; target < options.num_targets; ++target) {
    arm.targets.push_back(
        {"target" + std::to_string(target + 1), RandomFrame(0.2, random)});
  }
  return arm;
}

Eigen::MatrixXd RandomJointValues(const Arm& arm, int num_poses,
                                  Random* random) {
  Eigen::MatrixXd joint_values(arm.num_joints(), num_poses);
  for (int i = 0; i < num_poses; ++i) {
    for (int j = 0; j < arm.num_joints(); ++j) {
      joint_values(j, i) =
          random->Uniform(arm.joints[j].lower, arm.joints[j].upper);
    }
  }
  return joint_values;
}

}  // namespace alidade::internal::testing
