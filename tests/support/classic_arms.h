#ifndef ALIDADE_TESTS_SUPPORT_CLASSIC_ARMS_H_
#define ALIDADE_TESTS_SUPPORT_CLASSIC_ARMS_H_

#include <string>
#include <vector>

#include "alidade/arm.h"
#include "alidade/units.h"

namespace alidade::internal::testing {

/// One row of a modified Denavit-Hartenberg table: alpha and a of the link
/// before the joint, then theta offset and offset along the axis (deg, mm).
struct DhRow {
  double alpha_deg;
  double a_mm;
  double theta_deg;
  double r_mm;
  JointType type = JointType::kRevolute;
};

/// An arm with a target off its last axis, at (10, 20, 130) mm.
Arm MakeArm(const std::string& name, const std::vector<DhRow>& rows);

Arm Planar3R();

Arm Scara();

Arm Puma560();

Arm Stanford();

Arm Ur10();

Arm Panda();

Arm LiftingColumn();

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_CLASSIC_ARMS_H_
