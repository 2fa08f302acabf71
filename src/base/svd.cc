#include "alidade/base/svd.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <utility>

namespace alidade {
namespace {

using SquareSvd = Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner>;

Eigen::MatrixXd TriangularFactor(
    const Eigen::HouseholderQR<Eigen::MatrixXd>& qr) {
  return qr.matrixQR().topRows(qr.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

Svd ComputeSvd(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  const SquareSvd svd(TriangularFactor(qr),
                      Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
  u.topRows(matrix.cols()) = svd.matrixU();
  u.applyOnTheLeft(qr.householderQ());
  return {std::move(u), svd.singularValues(), svd.matrixV()};
}

Eigen::VectorXd SingularValues(const Eigen::MatrixXd& matrix) {
  if (matrix.size() == 0) return {};
  if (matrix.rows() < matrix.cols()) return SingularValues(matrix.transpose());
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  return SquareSvd(TriangularFactor(qr)).singularValues();
}

}  // namespace alidade
