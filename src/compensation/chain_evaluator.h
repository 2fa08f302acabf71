#ifndef ALIDADE_SRC_COMPENSATION_CHAIN_EVALUATOR_H_
#define ALIDADE_SRC_COMPENSATION_CHAIN_EVALUATOR_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/arm.h"

namespace alidade::internal {

/// The target's pose in the instrument's frame, and how joint values move it.
struct ChainState {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// Position (m) above rotation vector on the left (rad), per joint value.
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;
};

/// The model of alidade/forward_kinematics.h and error_terms.h for the same arm
/// at very many joint values: what does not depend on them is computed once,
/// and an evaluation allocates nothing. The Jacobian has the slopes of joint
/// functions, harmonics and coupling; what moments change with the joints is
/// left out (some 1e-3 of it). Not for several threads: one each.
class ChainEvaluator {
 public:
  ChainEvaluator(const Arm& arm, int target);

  int num_joints() const { return static_cast<int>(links_.size()); }
  /// @pre state->jacobian has one column per joint.
  void Evaluate(const double* joint_values, ChainState* state);

 private:
  /// What stands before a joint's variable, Rot(y, beta) Rot(x, alpha)
  /// Trans(x, d), and the rest of its row.
  struct Link {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d offset;
    double theta;
    double r;
    bool is_revolute;
  };

  static Link LinkOf(const Joint& joint);
  void ComputeErrors(const double* joint_values);
  void ComputeMoments(const double* joint_values);
  void FillJacobian(ChainState* state);

  ErrorTerms errors_;
  std::vector<Link> links_;
  std::vector<Link> load_links_;  ///< that moments are taken of
  Eigen::Isometry3d base_;
  Eigen::Isometry3d tool_;
  Eigen::Vector3d load_point_;  ///< of the payload, in the last frame
  bool needs_moments_ = false;
  bool has_coupling_ = false;
  Eigen::MatrixXd motion_;  ///< I + coupling
  // Of the last evaluation.
  Eigen::VectorXd shifts_;
  Eigen::VectorXd slopes_;  ///< of a joint's shift by its own value
  Eigen::Matrix2Xd tilts_;
  Eigen::Matrix3Xd axes_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd moments_;
  std::vector<Eigen::Matrix3d> load_frames_;
  Eigen::Matrix3Xd load_points_;
  Eigen::Matrix3Xd load_origins_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> uncoupled_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMPENSATION_CHAIN_EVALUATOR_H_
