#ifndef ALIDADE_SRC_SOLVE_DAMPED_STEP_H_
#define ALIDADE_SRC_SOLVE_DAMPED_STEP_H_

#include <Eigen/Core>

namespace alidade::internal {

/// Solves the least-squares problem of one step of Levenberg-Marquardt,
///
///   min over x of |R x + z|^2 + |P x + w|^2 + |D x|^2,
///
/// R upper triangular (p x p), P and D diagonal: what is measured, what is
/// known beforehand, and the damping. Householder transformations of [R; P, D]
/// that leave the zeros of both triangles alone (LAPACK's TPQRT), so that the
/// condition of R is not squared. 2 p^3 / 3 multiply-adds; allocates where p
/// changes.
class DampedStep {
 public:
  struct Diagonal {
    Eigen::VectorXd weights;    ///< P; 0 where nothing is known
    Eigen::VectorXd residuals;  ///< w
  };

  /// `damping`: D. The solution is not finite where a column is zero in all of
  /// R, P and D.
  const Eigen::VectorXd& Solve(const Eigen::MatrixXd& factor,
                               const Eigen::VectorXd& projected,
                               const Diagonal& known,
                               const Eigen::VectorXd& damping);

 private:
  void ClearColumn(Eigen::Index k);

  Eigen::MatrixXd upper_;    // R, then that of all
  Eigen::MatrixXd lower_;    // P and D, filled up to an upper triangle
  Eigen::VectorXd rotated_;  // z, then that of all
  Eigen::VectorXd rest_;     // w and below
  Eigen::VectorXd step_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_DAMPED_STEP_H_
