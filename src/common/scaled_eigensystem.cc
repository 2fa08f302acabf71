#include "src/common/scaled_eigensystem.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "src/common/constants.h"

namespace alidade::internal {

ScaledEigensystem::ScaledEigensystem(const Eigen::MatrixXd& matrix)
    // NaN stays.
    : scale(matrix.diagonal().unaryExpr(
          [](double x) { return x <= 0.0 ? 0.0 : std::sqrt(x); })),
      inverse_scale(
          scale.unaryExpr([](double s) { return s == 0.0 ? 0.0 : 1.0 / s; })) {
  if (matrix.size() == 0) return;
  // Eigen leaves its results as memory was.
  if (!matrix.allFinite()) {
    values = Eigen::VectorXd::Constant(matrix.rows(), kNan);
    vectors = Eigen::MatrixXd::Constant(matrix.rows(), matrix.rows(), kNan);
    return;
  }
  // Evaluated: Eigen would compile the solver once more for the product.
  const Eigen::MatrixXd scaled =
      inverse_scale.asDiagonal() * matrix * inverse_scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

Eigen::MatrixXd ScaledEigensystem::Root() const {
  return scale.asDiagonal() * vectors *
         values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd ScaledEigensystem::PseudoInverse(double least,
                                                 int* rank) const {
  *rank = 0;
  const Eigen::VectorXd inverse = values.unaryExpr([&](double x) {
    if (x <= least) return 0.0;
    ++*rank;
    return 1.0 / x;
  });
  const Eigen::MatrixXd scaled = inverse_scale.asDiagonal() * vectors;
  return scaled * inverse.asDiagonal() * scaled.transpose();
}

}  // namespace alidade::internal
