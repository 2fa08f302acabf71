#include "src/identifiability/elimination.h"

#include <Eigen/QR>

namespace alidade::internal {

Elimination Eliminate(const Eigen::MatrixXd& factor, double tolerance) {
  Elimination elimination;
  if (factor.cols() == 0) return elimination;
  const double zero = tolerance * factor.colwise().norm().maxCoeff();
  Eigen::MatrixXd basis(factor.rows(), 0);
  Eigen::MatrixXd kept(factor.rows(), 0);
  for (Eigen::Index c = 0; c < factor.cols(); ++c) {
    const Eigen::VectorXd column = factor.col(c);
    Eigen::VectorXd rest = column;
    // Twice is enough: one pass of Gram-Schmidt leaves rounding of the kept
    // columns behind (Kahan; Parlett 1980, "The symmetric eigenvalue problem").
    for (int pass = 0; pass < 2; ++pass) {
      rest -= basis * (basis.transpose() * rest).eval();
    }
    const auto index = static_cast<int>(c);
    if (column.norm() <= zero) {
      elimination.dependent.push_back(
          {index, Eigen::VectorXd::Zero(kept.cols()), true});
    } else if (rest.norm() <= tolerance * column.norm()) {
      elimination.dependent.push_back(
          {index, kept.colPivHouseholderQr().solve(column), false});
    } else {
      elimination.kept.push_back(index);
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols<1>() = rest.normalized();
      kept.conservativeResize(Eigen::NoChange, basis.cols());
      kept.rightCols<1>() = column;
    }
  }
  return elimination;
}

}  // namespace alidade::internal
