#include "src/model/joint_draw.h"

#include "alidade/interruption.h"
#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/motors.h"

namespace alidade::internal {

double DrawJointValue(const Arm& arm, int j, Random* random) {
  const Joint& joint = arm.joints[j];
  if (HasLimits(joint)) {
    return random->Uniform(joint.lower, joint.upper);
  }
  const double range = joint.type == JointType::kRevolute ? kPi : ArmReach(arm);
  return random->Uniform(-range, range);
}

Eigen::MatrixXd DrawJointValues(const Arm& arm, int count, std::uint64_t seed) {
  Eigen::MatrixXd joint_values(arm.num_joints(), count);
  for (int i = 0; i < count; ++i) {
    if (i % 1024 == 0) CheckInterruption();
    Random random(seed, static_cast<std::uint64_t>(i));
    for (int j = 0; j < arm.num_joints(); ++j) {
      joint_values(j, i) = DrawJointValue(arm, j, &random);
    }
  }
  if (!HasFewerMotors(arm)) return joint_values;
  return JointsFromMotors(arm, MotorsFromJoints(arm, joint_values));
}

}  // namespace alidade::internal
