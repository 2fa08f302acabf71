#include "tests/support/classic_arms.h"

namespace alidade::internal::testing {

Arm MakeArm(const std::string& name, const std::vector<DhRow>& rows) {
  Arm arm;
  arm.name = name;
  for (const DhRow& row : rows) {
    Joint joint;
    joint.type = row.type;
    joint.alpha = row.alpha_deg * kDegree;
    joint.d = row.a_mm * kMillimetre;
    joint.theta = row.theta_deg * kDegree;
    joint.r = row.r_mm * kMillimetre;
    const bool revolute = row.type == JointType::kRevolute;
    joint.lower = revolute ? -2.5 : 0.1;
    joint.upper = revolute ? 2.5 : 0.6;
    arm.joints.push_back(joint);
  }
  arm.last_from_target().translation() =
      Eigen::Vector3d(10.0, 20.0, 130.0) * kMillimetre;
  return arm;
}

Arm Planar3R() {
  return MakeArm("planar 3R", {{0, 0, 0, 0}, {0, 300, 0, 0}, {0, 250, 0, 0}});
}

Arm Scara() {
  return MakeArm("SCARA", {{0, 0, 0, 400},
                           {0, 325, 0, 0},
                           {0, 225, 0, 0, JointType::kPrismatic},
                           {0, 0, 0, 0}});
}

Arm Puma560() {
  return MakeArm("PUMA 560", {{0, 0, 0, 0},
                              {-90, 0, 0, 243.5},
                              {0, 431.8, 0, -93.4},
                              {-90, -20.32, 0, 433.1},
                              {90, 0, 0, 0},
                              {-90, 0, 0, 0}});
}

Arm Stanford() {
  return MakeArm("Stanford arm", {{0, 0, 0, 412},
                                  {-90, 0, 0, 154},
                                  {90, 0, 0, 0, JointType::kPrismatic},
                                  {0, 0, 0, 0},
                                  {-90, 0, 0, 0},
                                  {90, 0, 0, 263}});
}

Arm Ur10() {
  return MakeArm("UR10", {{0, 0, 0, 127.3},
                          {90, 0, 0, 0},
                          {0, -612, 0, 0},
                          {0, -572.3, 0, 163.941},
                          {90, 0, 0, 115.7},
                          {-90, 0, 0, 92.2}});
}

Arm Panda() {
  return MakeArm("Panda", {{0, 0, 0, 333},
                           {-90, 0, 0, 0},
                           {90, 0, 0, 316},
                           {90, 82.5, 0, 0},
                           {-90, -82.5, 0, 384},
                           {90, 0, 0, 0},
                           {90, 88, 0, 107}});
}

Arm LiftingColumn() {
  return MakeArm("column and 6R", {{0, 0, 90, 0, JointType::kPrismatic},
                                   {90, 0, 0, 152.5},
                                   {-90, 34.5, -90, 0},
                                   {0, 620, 90, 0},
                                   {90, 0, 0, 559},
                                   {-90, 0, 0, 0},
                                   {90, 0, 0, 121}});
}

}  // namespace alidade::internal::testing
