#include "src/common/svd.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>
#include <utility>

#include "src/common/constants.h"

namespace alidade::internal {
namespace {

using SquareSvd = Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner>;

Eigen::MatrixXd TriangularFactor(
    const Eigen::HouseholderQR<Eigen::MatrixXd>& qr) {
  return qr.matrixQR().topRows(qr.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

Svd ComputeSvd(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::MatrixXd factor = TriangularFactor(qr);
  const Eigen::Index size = factor.cols();
  // Eigen leaves its results as memory was.
  if (!factor.allFinite()) {
    return {Eigen::MatrixXd::Constant(matrix.rows(), size, kNan),
            Eigen::VectorXd::Constant(size, kNan),
            Eigen::MatrixXd::Constant(size, size, kNan)};
  }
  const SquareSvd svd(factor, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
  u.topRows(matrix.cols()) = svd.matrixU();
  u.applyOnTheLeft(qr.householderQ());
  return {std::move(u), svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  if (matrix.rows() < matrix.cols()) return SingularValues(matrix.transpose());
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::MatrixXd factor = TriangularFactor(qr);
  if (!factor.allFinite()) {
    return Eigen::VectorXd::Constant(factor.cols(), kNan);
  }
  return SquareSvd(factor).singularValues();
}

Eigen::VectorXd SolveByMinimumNorm(const Eigen::MatrixXd& a,
                                   const Eigen::VectorXd& b, double tolerance) {
  const Svd svd = ComputeSvd(a);
  // The reciprocal of a smaller one is none.
  const double least =
      std::max(tolerance * svd.values[0], std::numeric_limits<double>::min());
  const Eigen::VectorXd inverse = svd.values.unaryExpr(
      [&](double value) { return value <= least ? 0.0 : 1.0 / value; });
  const Eigen::VectorXd in_axes = svd.u.transpose() * b;
  return svd.v * in_axes.cwiseProduct(inverse);
}

Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& matrix,
                                 double tolerance) {
  if (matrix.size() == 0) return Eigen::MatrixXd(matrix.rows(), 0);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(tolerance);
  qr.compute(matrix);
  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(matrix.rows(), qr.rank());
  basis.applyOnTheLeft(qr.householderQ());
  return basis;
}

}  // namespace alidade::internal
