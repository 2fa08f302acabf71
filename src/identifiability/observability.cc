#include "src/identifiability/observability.h"

#include <cmath>
#include <limits>

#include "src/common/svd.h"

namespace alidade::internal {

ObservabilityIndices ComputeObservability(const Eigen::MatrixXd& factor,
                                          Eigen::Index num_poses) {
  ObservabilityIndices indices;
  indices.condition = std::numeric_limits<double>::infinity();
  if (factor.cols() == 0 || num_poses == 0) return indices;
  const Eigen::VectorXd s = SingularValues(factor);
  const double largest = s[0];
  const double smallest = s[s.size() - 1];
  const double rounding =
      std::numeric_limits<double>::epsilon() * static_cast<double>(s.size());
  if (factor.rows() < factor.cols() || !(smallest > rounding * largest)) {
    return indices;
  }
  // By logarithms: a product of forty singular values may overflow.
  indices.o1 = std::exp(s.array().log().mean()) /
               std::sqrt(static_cast<double>(num_poses));
  indices.o2 = smallest / largest;
  indices.o3 = smallest;
  indices.o4 = smallest * smallest / largest;
  indices.o5 = 1.0 / s.cwiseInverse().sum();
  indices.condition = largest / smallest;
  return indices;
}

namespace {

constexpr double kRankTolerance = 1e-12;

// Rounding leaves this much of a direction in parameters it has no part in.
constexpr double kNoPart = 1e-6;

// The rows of data and priors, columns brought to unit norm.
struct StackedRows {
  Svd svd;
  Eigen::VectorXd norms;

  bool IsTold(Eigen::Index i) const {
    return svd.values[i] > kRankTolerance * svd.values[0];
  }
};

StackedRows Stack(const Eigen::MatrixXd& whitened_factor,
                  const Eigen::VectorXd& prior) {
  const Eigen::Index p = whitened_factor.cols();
  Eigen::MatrixXd stacked(whitened_factor.rows() + p, p);
  stacked.topRows(whitened_factor.rows()) = whitened_factor;
  stacked.bottomRows(p) = prior.cwiseInverse().asDiagonal();
  Eigen::VectorXd norms = stacked.colwise().norm();
  for (double& norm : norms) norm = norm > 0.0 ? norm : 1.0;
  stacked *= norms.cwiseInverse().asDiagonal();
  return {ComputeSvd(stacked), norms};
}

}  // namespace

Eigen::VectorXd PredictDeviations(const Eigen::MatrixXd& whitened_factor,
                                  const Eigen::VectorXd& prior) {
  const Eigen::Index p = whitened_factor.cols();
  if (p == 0) return {};
  const StackedRows rows = Stack(whitened_factor, prior);
  Eigen::VectorXd deviations(p);
  for (Eigen::Index k = 0; k < p; ++k) {
    double variance = 0.0;
    for (Eigen::Index i = 0; i < p; ++i) {
      const double part = rows.svd.v(k, i);
      if (rows.IsTold(i)) {
        variance += part * part / (rows.svd.values[i] * rows.svd.values[i]);
      } else if (std::abs(part) > kNoPart) {
        variance = std::numeric_limits<double>::infinity();
      }
    }
    deviations[k] = std::sqrt(variance) / rows.norms[k];
  }
  return deviations;
}

double PredictTotal(const Eigen::MatrixXd& whitened_factor,
                    const Eigen::VectorXd& prior,
                    const Eigen::MatrixXd& other) {
  if (whitened_factor.cols() == 0) return 0.0;
  const StackedRows rows = Stack(whitened_factor, prior);
  const Eigen::MatrixXd seen =
      other * rows.norms.cwiseInverse().asDiagonal() * rows.svd.v;
  double variance = 0.0;
  for (Eigen::Index i = 0; i < seen.cols(); ++i) {
    const double part = seen.col(i).norm();
    if (rows.IsTold(i)) {
      variance += part * part / (rows.svd.values[i] * rows.svd.values[i]);
    } else if (part > kNoPart * seen.norm()) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return std::sqrt(variance);
}

}  // namespace alidade::internal
