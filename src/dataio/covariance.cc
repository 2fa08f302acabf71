#include "src/dataio/covariance.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace alidade::internal {
namespace {

// A pivot below this times its variance is rounding: a direction without
// noise.
constexpr double kMinPivot = 1e-12;

Eigen::MatrixXd WhitenerOf(const Noise& noise) {
  if (noise.whitener.size() > 0) return noise.whitener;
  return noise.sigmas.cwiseInverse().asDiagonal();
}

}  // namespace

Noise IndependentNoise(const Eigen::VectorXd& sigmas) { return {sigmas, {}}; }

std::optional<Noise> CorrelatedNoise(const Eigen::MatrixXd& covariance,
                                     const std::vector<bool>& is_measured) {
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < is_measured.size(); ++i) {
    if (is_measured[i]) rows.push_back(static_cast<Eigen::Index>(i));
  }
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd measured(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      measured(i, j) = covariance(rows[i], rows[j]);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(measured);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixXd factor = cholesky.matrixL();
  const Eigen::MatrixXd whitener =
      cholesky.matrixL().solve(Eigen::MatrixXd::Identity(size, size));
  Noise noise;
  noise.sigmas.setConstant(covariance.rows(),
                           std::numeric_limits<double>::infinity());
  noise.whitener.setZero(covariance.rows(), covariance.rows());
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!(factor(i, i) * factor(i, i) > kMinPivot * measured(i, i))) {
      return std::nullopt;
    }
    noise.sigmas[rows[i]] = std::sqrt(measured(i, i));
    for (Eigen::Index j = 0; j < size; ++j) {
      noise.whitener(rows[i], rows[j]) = whitener(i, j);
    }
  }
  return noise;
}

Noise StackNoise(const Noise& top, const Noise& bottom) {
  const Eigen::Index n = top.sigmas.size();
  const Eigen::Index m = bottom.sigmas.size();
  Noise noise;
  noise.sigmas.resize(n + m);
  noise.sigmas << top.sigmas, bottom.sigmas;
  if (top.whitener.size() == 0 && bottom.whitener.size() == 0) return noise;
  noise.whitener.setZero(n + m, n + m);
  noise.whitener.topLeftCorner(n, n) = WhitenerOf(top);
  noise.whitener.bottomRightCorner(m, m) = WhitenerOf(bottom);
  return noise;
}

}  // namespace alidade::internal
