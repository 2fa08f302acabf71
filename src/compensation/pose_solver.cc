#include "src/compensation/pose_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/interruption.h"
#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

// Longer steps (rad) leave the range in which the Jacobian says anything.
constexpr double kLongestStep = 0.3;
constexpr double kLeastDamping = 1e-7;
constexpr double kMostDamping = 1e3;
// Steps that are nothing: of the whole, and of what only settles.
constexpr double kNoStep = 1e-14;
constexpr double kSettled = 1e-9;
// Steps that parts of the task after the first have: where they do not settle
// (a direction that joints hardly move comes and goes), the first must.
constexpr int kMostSettling = 12;
// Steps in a row that bring the target hardly nearer: it is out of reach.
constexpr int kMostSlow = 6;
// Cost (squared, in parts of the reach) below which steps that serve later
// parts of the task may add a second-order error to the first.
constexpr double kNearCost = 1e-6;

bool IsPose(PoseTask task, int num_joints) {
  if (num_joints < 6) return false;
  return task == PoseTask::kPose || task == PoseTask::kAutomatic;
}

std::vector<TaskLevel> MakeLevels(const PoseSolverOptions& options,
                                  bool is_pose, int num_joints) {
  std::vector<int> rows = {3};  // position
  if (is_pose) {
    rows = {6};
  } else if (options.task != PoseTask::kPosition) {
    rows.push_back(3);                                       // axis
    if (options.task != PoseTask::kAxis) rows.push_back(1);  // turn about it
  }
  std::vector<TaskLevel> levels(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    levels[k].jacobian.setZero(rows[k], num_joints);
    levels[k].error.setZero(rows[k]);
  }
  return levels;
}

}  // namespace

PoseSolver::PoseSolver(const Arm& arm, const PoseSolverOptions& options)
    : arm_(arm),
      options_(options),
      reach_(ArmReach(arm)),
      is_pose_(IsPose(options.task, arm.num_joints())),
      is_square_(is_pose_ && arm.num_joints() == 6),
      chain_(arm, options.target),
      stepper_(arm.num_joints()),
      levels_(MakeLevels(options, is_pose_, arm.num_joints())) {
  const int n = arm.num_joints();
  scaled_.resize(6, n);
  lower_.resize(n);
  upper_.resize(n);
  unit_.setOnes(n);
  for (int j = 0; j < n; ++j) {
    const Joint& joint = arm.joints[j];
    const bool has_both =
        std::isfinite(joint.lower) && std::isfinite(joint.upper);
    const bool counts = HasLimits(joint) || !has_both;
    lower_[j] = counts ? joint.lower : -std::numeric_limits<double>::infinity();
    upper_[j] = counts ? joint.upper : std::numeric_limits<double>::infinity();
    if (joint.type == JointType::kPrismatic) unit_[j] = reach_;
  }
  start_.resize(n);
  home_.resize(n);
  step_.resize(n);
  locked_.assign(n, false);
  for (Place* place : {&current_, &trial_}) {
    place->state.jacobian.resize(6, n);
    place->joint_values.resize(n);
  }
}

void PoseSolver::MoveTo(const Eigen::Isometry3d& target, Place* place) {
  chain_.Evaluate(place->joint_values.data(), &place->state);
  place->error.head<3>() = target.translation() - place->state.position;
  const Eigen::Matrix3d turn =
      target.linear() * place->state.rotation.transpose();
  place->error.tail<3>() = VectorFromRotation(turn);
  place->position = place->error.head<3>().norm();
  place->rotation = place->error.tail<3>().norm();
  const double position = place->position / reach_;
  const double rotation = is_pose_ ? place->rotation : 0.0;
  place->cost = position * position + rotation * rotation;
}

bool PoseSolver::IsReached(const Place& place) const {
  return place.position <= options_.position_tolerance &&
         (!is_pose_ || place.rotation <= options_.rotation_tolerance);
}

void PoseSolver::ClampToLimits(Eigen::VectorXd* joint_values) const {
  *joint_values = joint_values->cwiseMax(lower_).cwiseMin(upper_);
}

// Joint motions in units of 1 rad or the reach, lengths in parts of the reach.
void PoseSolver::FillLevels(const Place& place) {
  const Eigen::Vector3d turn = place.error.tail<3>();
  const auto rotation_rows = scaled_.bottomRows<3>();
  if (is_pose_) {
    levels_[0].jacobian = scaled_;
    levels_[0].error << place.error.head<3>() / reach_, turn;
    return;
  }
  levels_[0].jacobian = scaled_.topRows<3>();
  levels_[0].error = place.error.head<3>() / reach_;
  if (levels_.size() == 1) return;
  const Eigen::Vector3d axis = place.state.rotation.col(2);
  // The shortest turn of the axis is that of the whole rotation but for the
  // part about it, to first order; at the answer both are zero.
  levels_[1].error = turn - axis * axis.dot(turn);
  levels_[1].jacobian.noalias() =
      rotation_rows - axis * (axis.transpose() * rotation_rows);
  if (levels_.size() == 2) return;
  levels_[2].error[0] = axis.dot(turn);
  levels_[2].jacobian.noalias() = axis.transpose() * rotation_rows;
}

void PoseSolver::StepOnce(const Place& place, double* mu) {
  if (is_square_ && !any_locked_) {
    Vector6d error = place.error;
    error.head<3>() /= reach_;
    stepper_.Newton(scaled_, error, kLongestStep, mu, &step_);
  } else {
    home_ = (start_ - place.joint_values).cwiseQuotient(unit_);
    if (only_first_) home_.setZero();
    stepper_.Prioritised(levels_, only_first_ ? 1 : levels_.size(), *mu,
                         locked_, home_, &step_);
    const double longest = step_.cwiseAbs().maxCoeff();
    if (longest > kLongestStep) step_ *= kLongestStep / longest;
  }
  step_ = step_.cwiseProduct(unit_);
}

// Joints at a limit that the step pushes on; whether there are new ones.
bool PoseSolver::LockOutward(const Place& place) {
  bool found = false;
  for (Eigen::Index j = 0; j < step_.size(); ++j) {
    const double q = place.joint_values[j];
    const bool pushes = (q >= upper_[j] && step_[j] > 0.0) ||
                        (q <= lower_[j] && step_[j] < 0.0);
    if (!pushes || locked_[j]) continue;
    locked_[j] = found = true;
  }
  return found;
}

void PoseSolver::ComputeStep(const Place& place, double* mu) {
  scaled_ = place.state.jacobian;
  scaled_.topRows<3>() /= reach_;
  for (Eigen::Index j = 0; j < scaled_.cols(); ++j) {
    if (unit_[j] != 1.0) scaled_.col(j) *= unit_[j];
  }
  if (any_locked_) std::fill(locked_.begin(), locked_.end(), false);
  any_locked_ = false;
  if (!is_square_) FillLevels(place);
  StepOnce(place, mu);
  while (LockOutward(place)) {
    if (!any_locked_) FillLevels(place);
    any_locked_ = true;
    StepOnce(place, mu);
  }
}

void PoseSolver::Iterate(const Eigen::Isometry3d& target, int* iterations) {
  double mu = 0.0;
  for (; *iterations < options_.max_iterations; ++*iterations) {
    const bool is_reached = IsReached(current_);
    only_first_ = *iterations >= kMostSettling;
    if (is_reached && (is_square_ || only_first_)) return;
    ComputeStep(current_, &mu);
    const double moved = step_.cwiseQuotient(unit_).cwiseAbs().maxCoeff();
    if (moved < kNoStep || (is_reached && moved < kSettled)) return;
    trial_.joint_values = current_.joint_values + step_;
    ClampToLimits(&trial_.joint_values);
    MoveTo(target, &trial_);
    // Where later parts of a task have their time, they take it of the steps.
    const bool is_slow =
        trial_.cost > 0.99 * current_.cost && (is_square_ || only_first_);
    num_slow_ = is_slow ? num_slow_ + 1 : 0;
    if (num_slow_ > kMostSlow && !is_reached) return;
    const bool is_nearer =
        trial_.cost < current_.cost || (!is_square_ && trial_.cost < kNearCost);
    if (is_nearer) {
      std::swap(current_, trial_);
      mu = mu < 10.0 * kLeastDamping ? 0.0 : 0.1 * mu;
    } else if (is_reached || mu > kMostDamping) {
      return;
    } else {
      mu = std::max(kLeastDamping, 10.0 * mu);
    }
  }
}

double PoseSolver::Determinant(const Place& place) const {
  const Matrix6d square = place.state.jacobian;
  return square.partialPivLu().determinant();
}

PoseStatus PoseSolver::StatusOf(double determinant_before) const {
  if (!IsReached(current_)) {
    return any_locked_ ? PoseStatus::kLimit : PoseStatus::kOutOfReach;
  }
  const double moved = (current_.joint_values - start_)
                           .cwiseQuotient(unit_)
                           .cwiseAbs()
                           .maxCoeff();
  if (moved > options_.max_joint_change) return PoseStatus::kBranchChange;
  const bool has_flipped =
      is_square_ && std::isfinite(options_.max_joint_change) &&
      std::signbit(Determinant(current_)) != std::signbit(determinant_before);
  return has_flipped ? PoseStatus::kBranchChange : PoseStatus::kReached;
}

PoseSolution PoseSolver::Solve(const Eigen::Isometry3d& target,
                               Eigen::VectorXd* joint_values) {
  CheckInterruption();
  start_ = *joint_values;
  current_.joint_values = start_;
  ClampToLimits(&current_.joint_values);
  any_locked_ = only_first_ = false;
  num_slow_ = 0;
  std::fill(locked_.begin(), locked_.end(), false);
  PoseSolution solution;
  if (!start_.allFinite() || !target.matrix().allFinite()) return solution;
  MoveTo(target, &current_);
  const double before = is_square_ ? Determinant(current_) : 0.0;
  Iterate(target, &solution.iterations);
  *joint_values = current_.joint_values;
  solution.position_error = current_.position;
  solution.rotation_error = current_.rotation;
  solution.status = StatusOf(before);
  return solution;
}

}  // namespace alidade::internal
