#ifndef ALIDADE_SRC_COMPENSATION_POSE_STEP_H_
#define ALIDADE_SRC_COMPENSATION_POSE_STEP_H_

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

namespace alidade::internal {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// One part of a task, in the order of weight: jacobian * step should be
/// `error`. At most six rows.
struct TaskLevel {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor>
      jacobian;
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1> error;
};

/// Below this (rad per rad) a direction is no use for later parts of a task.
inline constexpr double kLeastMotion = 0.1;

/// Steps of Newton's method (alidade/inverse_kinematics.h), with scratch memory
/// for arms of `num_joints` joints.
class PoseStep {
 public:
  explicit PoseStep(int num_joints);

  /// J^-1 error, or with mu > 0 the damped step, mu being raised until no joint
  /// moves by more than `longest`. @pre six joints.
  void Newton(const Matrix6Xd& jacobian, const Vector6d& error, double longest,
              double* mu, Eigen::VectorXd* step);

  /// The first `count` levels, each in the null space of those before; what is
  /// left of it moves joints towards `home` (relative to where they are).
  /// Joints that are locked do not move.
  void Prioritised(const std::vector<TaskLevel>& levels, std::size_t count,
                   double mu, const std::vector<bool>& locked,
                   const Eigen::VectorXd& home, Eigen::VectorXd* step);

 private:
  Eigen::MatrixXd projector_;
  Eigen::MatrixXd projected_;
  Eigen::VectorXd row_;
  Eigen::VectorXd rest_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMPENSATION_POSE_STEP_H_
