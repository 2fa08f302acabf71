#include "tests/support/error_term_kinematics.h"

namespace alidade::internal::testing {

Arm WithRandomErrors(const Arm& nominal, Random* random) {
  Arm arm = nominal;
  for (Joint& joint : arm.joints) {
    for (double* angle : {&joint.beta, &joint.alpha, &joint.theta}) {
      *angle += random->Uniform(-3e-3, 3e-3);
    }
    for (double* length : {&joint.d, &joint.r}) {
      *length += random->Uniform(-5e-4, 5e-4);
    }
    JointErrors errors;
    const bool turns = joint.type == JointType::kRevolute;
    for (double& value : errors.compliance) {
      value = random->Uniform(0.0, 2e-5);
    }
    errors.function.first = -3.0;
    errors.function.spacing = 0.05;
    errors.function.values.resize(121);
    double value = 0.0;
    for (double& at : errors.function.values) {
      value = 0.9 * value + 5e-5 * random->Normal();
      at = value;
    }
    if (turns) {
      errors.harmonics = {{1.0, random->Uniform(-2e-4, 2e-4), 1e-4},
                          {2.0, 5e-5, random->Uniform(-1e-4, 1e-4)}};
      errors.backlash = 2e-5;
    }
    arm.errors.joints.push_back(errors);
  }
  const int n = arm.num_joints();
  arm.errors.coupling.setZero(n, n);
  for (int j = 0; j < n; ++j) {
    arm.errors.coupling(j, j) = random->Uniform(-2e-4, 2e-4);
    if (j > 0) arm.errors.coupling(j, j - 1) = random->Uniform(-2e-4, 2e-4);
  }
  return arm;
}

}  // namespace alidade::internal::testing
