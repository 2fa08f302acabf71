#include "tests/support/rv2aj_arms.h"

namespace alidade::internal::testing {

Arm Rv2ajWrist() {
  Arm arm;
  arm.name = "rv2aj_wrist";
  arm.joints.resize(5);
  arm.joints[0].r = 300.0 * kMillimetre;
  arm.joints[1].alpha = -90.0 * kDegree;
  arm.joints[1].theta = -90.0 * kDegree;
  arm.joints[2].d = 250.0 * kMillimetre;
  arm.joints[3].d = 160.0 * kMillimetre;
  arm.joints[3].theta = 90.0 * kDegree;
  arm.joints[4].alpha = 90.0 * kDegree;
  const double lower_deg[] = {-150.0, -60.0, -110.0, -90.0, -200.0};
  const double upper_deg[] = {150.0, 120.0, 120.0, 90.0, 200.0};
  for (int j = 0; j < arm.num_joints(); ++j) {
    arm.joints[j].lower = lower_deg[j] * kDegree;
    arm.joints[j].upper = upper_deg[j] * kDegree;
  }
  return arm;
}

Arm Rv2ajFlange() {
  Arm arm = Rv2ajWrist();
  arm.name = "rv2aj_flange";
  arm.joints[4].r = 72.0 * kMillimetre;
  return arm;
}

Arm WithRv2ajDeviations(const Arm& nominal) {
  Arm arm = nominal;
  arm.joints[0].beta += 0.009;
  arm.joints[0].alpha += 0.005;
  arm.joints[0].r += 0.1 * kMillimetre;
  arm.joints[1].alpha += 0.0001;
  arm.joints[1].d += -0.1 * kMillimetre;
  arm.joints[1].r += 1.0 * kMillimetre;
  arm.joints[2].beta += -0.0001;
  arm.joints[2].alpha += 0.0009;
  arm.joints[2].d += -1.0 * kMillimetre;
  arm.joints[2].r += -0.1 * kMillimetre;
  arm.joints[3].beta += 0.004;
  arm.joints[3].d += 0.1 * kMillimetre;
  arm.joints[3].r += 0.1 * kMillimetre;
  arm.joints[4].r += 0.1 * kMillimetre;
  return arm;
}

}  // namespace alidade::internal::testing
