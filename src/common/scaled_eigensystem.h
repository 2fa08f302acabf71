#ifndef ALIDADE_SRC_COMMON_SCALED_EIGENSYSTEM_H_
#define ALIDADE_SRC_COMMON_SCALED_EIGENSYSTEM_H_

#include <Eigen/Core>

namespace alidade::internal {

/// The eigenvalues and vectors of a symmetric matrix A without negative ones,
/// scaled to a unit diagonal so that radians and metres do not mix:
/// A = S V diag(values) V^T S. Where a diagonal entry is 0, or below it by
/// rounding, its row and column count as 0. Where the matrix is not finite, all
/// is NaN. O(n^3).
struct ScaledEigensystem {
  explicit ScaledEigensystem(const Eigen::MatrixXd& matrix);

  Eigen::VectorXd scale;          ///< S, the roots of the diagonal
  Eigen::VectorXd inverse_scale;  ///< 0 where the scale is
  Eigen::VectorXd values;         ///< ascending
  Eigen::MatrixXd vectors;        ///< V, by columns

  /// R with R R^T = A; eigenvalues below 0 count as 0.
  Eigen::MatrixXd Root() const;

  /// S^+ V diag(1 / values) V^T S^+ without the values up to `least`, whose
  /// mean is 1 where no diagonal entry is 0; `rank` is the number of the
  /// others.
  Eigen::MatrixXd PseudoInverse(double least, int* rank) const;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_SCALED_EIGENSYSTEM_H_
