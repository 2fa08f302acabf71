#include "alidade/model/arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace alidade {

double Reach(const Arm& arm) {
  double farthest = 0.0;
  for (const Target& target : arm.targets) {
    farthest = std::max(farthest, target.last_from_target.translation().norm());
  }
  double reach = arm.instrument_from_base.translation().norm() + farthest;
  for (const Joint& joint : arm.joints) {
    reach += std::abs(joint.d) + std::abs(joint.r);
    if (joint.type == JointType::kPrismatic && std::isfinite(joint.lower) &&
        std::isfinite(joint.upper)) {
      reach += std::max(std::abs(joint.lower), std::abs(joint.upper));
    }
  }
  return reach > 0.0 ? reach : 1.0;
}

Eigen::MatrixXd JointsFromMotors(const Arm& arm,
                                 const Eigen::MatrixXd& motors) {
  Eigen::MatrixXd joints = motors;
  if (arm.joints_from_motors.size() > 0) {
    joints = arm.joints_from_motors * motors;
  }
  if (arm.motor_offsets.size() > 0) joints.colwise() += arm.motor_offsets;
  return joints;
}

Eigen::MatrixXd MotorsFromJoints(const Arm& arm,
                                 const Eigen::MatrixXd& joints) {
  Eigen::MatrixXd motors = joints;
  if (arm.motor_offsets.size() > 0) motors.colwise() -= arm.motor_offsets;
  if (arm.joints_from_motors.size() > 0) {
    motors = arm.joints_from_motors.partialPivLu().solve(motors).eval();
  }
  return motors;
}

}  // namespace alidade
