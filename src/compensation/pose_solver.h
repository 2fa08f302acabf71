#ifndef ALIDADE_SRC_COMPENSATION_POSE_SOLVER_H_
#define ALIDADE_SRC_COMPENSATION_POSE_SOLVER_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/arm.h"
#include "alidade/inverse_kinematics.h"
#include "src/compensation/chain_evaluator.h"
#include "src/compensation/pose_step.h"

namespace alidade::internal {

/// The answer to one target; joint values apart.
struct PoseSolution {
  PoseStatus status = PoseStatus::kOutOfReach;
  double position_error = 0.0;  ///< (m)
  double rotation_error = 0.0;  ///< (rad)
  int iterations = 0;
};

/// SolvePoses for one target after the other, with the memory for it: one per
/// thread. The arm must outlive it.
class PoseSolver {
 public:
  PoseSolver(const Arm& arm, const PoseSolverOptions& options);

  /// `joint_values`: the start, then the answer.
  PoseSolution Solve(const Eigen::Isometry3d& target,
                     Eigen::VectorXd* joint_values);

 private:
  // Where the joints are, and what is left there.
  struct Place {
    ChainState state;
    Eigen::VectorXd joint_values;
    Vector6d error;         // m and rad
    double position = 0.0;  // norms of it
    double rotation = 0.0;
    double cost = 0.0;  // of what must not grow
  };

  void MoveTo(const Eigen::Isometry3d& target, Place* place);
  bool IsReached(const Place& place) const;
  void ClampToLimits(Eigen::VectorXd* joint_values) const;
  void FillLevels(const Place& place);
  void ComputeStep(const Place& place, double* mu);
  void StepOnce(const Place& place, double* mu);
  bool LockOutward(const Place& place);
  void Iterate(const Eigen::Isometry3d& target, int* iterations);
  double Determinant(const Place& place) const;
  PoseStatus StatusOf(double determinant_before) const;

  const Arm& arm_;
  const PoseSolverOptions options_;
  const double reach_;
  const bool is_pose_;    // position and rotation alike
  const bool is_square_;  // and six joints
  ChainEvaluator chain_;
  PoseStep stepper_;
  std::vector<TaskLevel> levels_;
  Matrix6Xd scaled_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  Eigen::VectorXd unit_;  // of each joint's motion: 1 rad, or the reach
  Eigen::VectorXd start_;
  Eigen::VectorXd home_;
  Eigen::VectorXd step_;
  std::vector<bool> locked_;
  bool any_locked_ = false;
  bool only_first_ = false;  // part of the task, once the others had their time
  int num_slow_ = 0;
  Place current_;
  Place trial_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMPENSATION_POSE_SOLVER_H_
