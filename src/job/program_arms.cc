#include "src/job/program_arms.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/forward_kinematics.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {

CorrectionArms WithTool(const CorrectionArms& arms,
                        const Eigen::Isometry3d& flange_from_tool) {
  CorrectionArms with = arms;
  for (Arm* arm : {&with.nominal, &with.real}) {
    const Eigen::Vector3d load = MeanTargetOf(*arm);
    arm->last_from_target() = arm->last_from_target() * flange_from_tool;
    if (arm->errors.load_geometry.size() > 0) continue;
    arm->errors.payload.centre += load - MeanTargetOf(*arm);
  }
  return with;
}

Arm WithBounds(const Arm& arm, const Eigen::MatrixXd& bounds) {
  Arm narrow = arm;
  const Eigen::MatrixXd& map = arm.joints_from_motors;
  for (int j = 0; j < arm.num_joints(); ++j) {
    double scale = 1.0;
    if (map.size() > 0) {
      scale = map(j, j);
      if (std::abs(map.row(j).cwiseAbs().sum() - std::abs(scale)) > 0.0 ||
          scale == 0.0) {
        continue;
      }
    }
    const double offset =
        arm.motor_offsets.size() > 0 ? arm.motor_offsets[j] : 0.0;
    double lower = scale * bounds(j, 0) + offset;
    double upper = scale * bounds(j, 1) + offset;
    if (lower > upper) std::swap(lower, upper);
    Joint& joint = narrow.joints[j];
    const bool has_limits = HasLimits(joint);
    joint.lower = has_limits ? std::max(joint.lower, lower) : lower;
    joint.upper = has_limits ? std::min(joint.upper, upper) : upper;
  }
  return narrow;
}

bool IsSingular(const Arm& arm, const Eigen::VectorXd& joints) {
  // Of lengths in m: an axis 5 within some 0.1 deg of zero.
  constexpr double kSmallest = 1e-3;
  const int n = arm.num_joints();
  if (n < 6) return false;
  ChainAxes axes;
  ComputeChainAxes(arm, joints.data(), &axes);
  const Eigen::Vector3d target = axes.instrument_from_last.translation();
  Eigen::MatrixXd jacobian(6, n);
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector3d axis = axes.joint_axis.col(j);
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    const Eigen::Vector3d lever = target - axes.origin_on_axis.col(j);
    jacobian.col(j) << (turns ? axis.cross(lever) : axis),
        (turns ? axis : Eigen::Vector3d(Eigen::Vector3d::Zero()));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian);
  return svd.singularValues()[5] < kSmallest;
}

}  // namespace alidade::internal
