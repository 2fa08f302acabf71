#include "alidade/arm.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "alidade/units.h"

namespace alidade {

namespace {

double SumOfLengths(const Arm& arm) {
  double farthest = 0.0;
  for (const Target& target : arm.targets) {
    farthest = std::max(farthest, target.last_from_target.translation().norm());
  }
  double sum = farthest;
  for (const Joint& joint : arm.joints) {
    sum += std::abs(joint.d) + std::abs(joint.r);
    if (joint.type == JointType::kPrismatic && HasLimits(joint)) {
      sum += std::max(std::abs(joint.lower), std::abs(joint.upper));
    }
  }
  return sum;
}

// Joints that determine all motors, one for each.
std::vector<int> LeadingJoints(const Eigen::MatrixXd& joints_from_motors) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> rows(
      joints_from_motors.transpose());
  const auto& order = rows.colsPermutation().indices();
  std::vector<int> joints(order.data(),
                          order.data() + joints_from_motors.cols());
  std::sort(joints.begin(), joints.end());
  return joints;
}

}  // namespace

bool HasLimits(const Joint& joint) {
  constexpr double kMostTurns = 20.0;
  if (!std::isfinite(joint.lower) || !std::isfinite(joint.upper)) return false;
  if (joint.lower == joint.upper) return false;
  return joint.type != JointType::kRevolute ||
         joint.upper - joint.lower <= kMostTurns * 2.0 * kPi;
}

std::vector<Dimension> Arm::JointDimensions() const {
  std::vector<Dimension> dimensions;
  for (const Joint& joint : joints) dimensions.push_back(joint.dimension());
  return dimensions;
}

double ArmReach(const Arm& arm) {
  const double sum = SumOfLengths(arm);
  return sum > 0.0 ? sum : 1.0;
}

double Reach(const Arm& arm) {
  const double sum =
      arm.instrument_from_base.translation().norm() + SumOfLengths(arm);
  return sum > 0.0 ? sum : 1.0;
}

bool HasMotorMap(const Arm& arm) {
  return arm.joints_from_motors.size() > 0 || arm.motor_offsets.size() > 0;
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
  const Eigen::MatrixXd& map = arm.joints_from_motors;
  if (map.size() == 0) return motors;
  if (map.rows() == map.cols()) return map.partialPivLu().solve(motors);
  // The other joints follow.
  const std::vector<int> leading = LeadingJoints(map);
  Eigen::MatrixXd square(map.cols(), map.cols());
  Eigen::MatrixXd moved(map.cols(), motors.cols());
  for (Eigen::Index i = 0; i < map.cols(); ++i) {
    square.row(i) = map.row(leading[i]);
    moved.row(i) = motors.row(leading[i]);
  }
  return square.partialPivLu().solve(moved);
}

}  // namespace alidade
