#ifndef ALIDADE_SRC_COMMON_SVD_H_
#define ALIDADE_SRC_COMMON_SVD_H_

#include <Eigen/Core>

namespace alidade::internal {

/// A = U diag(values) V^T, values descending and not negative.
struct Svd {
  Eigen::MatrixXd u;       ///< rows x columns
  Eigen::VectorXd values;  ///< columns
  Eigen::MatrixXd v;       ///< columns x columns
};

/// Singular value decomposition of a matrix with at least as many rows as
/// columns: Householder QR, then one-sided Jacobi rotations of the triangular
/// factor, which keep small singular values to high relative accuracy (Demmel
/// and Veselic 1992, "Jacobi's method is more accurate than QR"). Here once,
/// since Eigen's templates take a minute to compile in every source.
/// Where the matrix is not finite, all is NaN. O(rows columns^2).
/// @pre rows >= columns >= 1.
Svd ComputeSvd(const Eigen::MatrixXd& matrix);

/// Only the values, of a matrix of any shape; empty for an empty one.
Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix);

/// The shortest of the x with the least |A x - b|. Singular values not above
/// `tolerance` times the largest count as zero. @pre as of ComputeSvd.
Eigen::VectorXd SolveByMinimumNorm(const Eigen::MatrixXd& a,
                                   const Eigen::VectorXd& b, double tolerance);

/// Orthonormal columns that span those of a finite matrix of any shape, by
/// Householder QR with column pivots: those whose pivot is above `tolerance`
/// times the largest.
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& matrix,
                                 double tolerance);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_SVD_H_
