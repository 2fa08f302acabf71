#include "alidade/inverse_kinematics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "src/model/chain_axes.h"

namespace alidade {

using internal::ChainAxes;
using internal::ComputeChainAxes;

namespace {

struct TaskState {
  Eigen::Matrix<double, 6, 1> error;  ///< wanted - current: m, then rad
  Eigen::MatrixXd jacobian;           ///< 6 x n, d(current) / d(joint values)
};

TaskState Evaluate(const Arm& arm, const PointingTask& task,
                   const Eigen::VectorXd& joint_values) {
  ChainAxes axes;
  ComputeChainAxes(arm, joint_values.data(), &axes);
  const Eigen::Vector3d position = axes.instrument_from_target.translation();
  const Eigen::Vector3d direction = axes.instrument_from_last.linear().col(2);
  TaskState state;
  state.error.setZero();
  state.error.head<3>() = task.position - position;
  state.jacobian.setZero(6, arm.num_joints());
  if (task.direction) state.error.tail<3>() = *task.direction - direction;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Eigen::Vector3d axis = axes.joint_axis.col(j);
    if (arm.joints[j].type == JointType::kPrismatic) {
      state.jacobian.col(j).head<3>() = axis;
      continue;
    }
    state.jacobian.col(j).head<3>() =
        axis.cross(position - axes.origin_on_axis.col(j));
    if (task.direction) {
      state.jacobian.col(j).tail<3>() = axis.cross(direction);
    }
  }
  return state;
}

bool IsReached(const TaskState& state,
               const InverseKinematicsOptions& options) {
  return state.error.head<3>().norm() <= options.position_tolerance &&
         state.error.tail<3>().norm() <= options.direction_tolerance;
}

// Longer steps leave the range in which the Jacobian says anything.
constexpr double kLongestStep = 0.5;

Eigen::VectorXd DampedStep(const TaskState& state, double reach) {
  Eigen::VectorXd error = state.error;
  Eigen::MatrixXd jacobian = state.jacobian;
  // In units of the reach, so that metres and radians weigh alike.
  error.head<3>() /= reach;
  jacobian.topRows<3>() /= reach;
  const double damping = std::min(1e-2, error.squaredNorm());
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  normal.diagonal().array() += damping + 1e-12;
  Eigen::VectorXd step = normal.ldlt().solve(jacobian.transpose() * error);
  const double longest = step.cwiseAbs().maxCoeff();
  if (longest > kLongestStep) step *= kLongestStep / longest;
  return step;
}

}  // namespace

std::optional<Eigen::VectorXd> SolveInverseKinematics(
    const Arm& arm, const PointingTask& task, const Eigen::VectorXd& start,
    const InverseKinematicsOptions& options) {
  const double reach = Reach(arm);
  Eigen::VectorXd joint_values = start;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const TaskState state = Evaluate(arm, task, joint_values);
    if (IsReached(state, options)) {
      if (!IsWithinLimits(arm, joint_values)) return std::nullopt;
      return joint_values;
    }
    joint_values += DampedStep(state, reach);
    if (!joint_values.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

bool IsWithinLimits(const Arm& arm, const Eigen::VectorXd& joint_values) {
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    const bool is_within =
        joint_values[j] >= joint.lower && joint_values[j] <= joint.upper;
    const bool has_both =
        std::isfinite(joint.lower) && std::isfinite(joint.upper);
    if (!is_within && (HasLimits(joint) || !has_both)) return false;
  }
  return true;
}

}  // namespace alidade
