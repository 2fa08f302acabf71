#include "src/model/motors.h"

#include "alidade/error.h"
#include "src/common/names.h"

namespace alidade::internal {

int NumMotors(const Arm& arm) {
  return arm.joints_from_motors.size() > 0
             ? static_cast<int>(arm.joints_from_motors.cols())
             : arm.num_joints();
}

bool HasFewerMotors(const Arm& arm) {
  return NumMotors(arm) < arm.num_joints();
}

std::vector<Dimension> MotorDimensions(const Arm& arm) {
  if (!HasFewerMotors(arm)) return arm.JointDimensions();
  std::vector<Dimension> dimensions;
  for (int motor = 0; motor < NumMotors(arm); ++motor) {
    int joint = 0;
    while (joint + 1 < arm.num_joints() &&
           arm.joints_from_motors(joint, motor) == 0.0) {
      ++joint;
    }
    dimensions.push_back(arm.joints[joint].dimension());
  }
  return dimensions;
}

void RequireFreeJoints(const Arm& arm) {
  if (!HasFewerMotors(arm)) return;
  throw InputError({}, "arm " + Quote(arm.name) +
                           " has fewer motors than joints, and inverse "
                           "kinematics would find joint values that its motors "
                           "cannot reach");
}

}  // namespace alidade::internal
