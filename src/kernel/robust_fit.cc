#include "src/kernel/robust_fit.h"

#include <Eigen/QR>
#include <algorithm>

namespace alidade::internal {
namespace {

// The prior of a target's coordinates (m): arms carry targets within reach of
// a hand.
constexpr double kTargetStddev = 0.5;

constexpr double kSmallestScale = 1e-6;

double Median(Eigen::VectorXd values) {
  double* const middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

}  // namespace

Eigen::VectorXd BlockNorms(const Eigen::VectorXd& residuals, int block_size) {
  return residuals.reshaped(block_size, residuals.size() / block_size)
      .colwise()
      .norm()
      .transpose();
}

double FitScale(const Eigen::VectorXd& norms, const FitRows& rows) {
  const double num_equations = static_cast<double>(rows.jacobian.rows());
  const double num_unknowns = static_cast<double>(rows.jacobian.cols());
  const double spare = std::max(1.0, num_equations - num_unknowns);
  return std::max(kSmallestScale,
                  Median(norms) * std::sqrt(num_equations / spare));
}

Eigen::VectorXd RobustWeights(const Eigen::VectorXd& norms, double scale,
                              FitWeighting weighting) {
  Eigen::VectorXd weights(norms.size());
  for (Eigen::Index i = 0; i < norms.size(); ++i) {
    if (weighting == FitWeighting::kHuber) {
      weights[i] = std::min(1.0, 2.0 * scale / norms[i]);
    } else {
      const double ratio = norms[i] / (kTukeyCut * scale);
      const double rest = std::max(0.0, 1.0 - ratio * ratio);
      weights[i] = rest * rest;
    }
  }
  return weights;
}

double WeighedSum(const FitRows& rows, const Eigen::VectorXd& weights,
                  double scale, const Eigen::Matrix3Xd& targets) {
  const Eigen::Index block_size = rows.residuals.size() / weights.size();
  const double prior = scale / kTargetStddev;
  return rows.residuals.reshaped(block_size, weights.size())
             .colwise()
             .squaredNorm()
             .dot(weights) +
         prior * prior * targets.squaredNorm();
}

void WeighRows(const Eigen::VectorXd& weights, double scale,
               const Eigen::Matrix3Xd& targets, int target_column,
               FitRows* rows) {
  const Eigen::Index num_rows = rows->residuals.size();
  const Eigen::Index block_size = num_rows / weights.size();
  const Eigen::Index num_prior = targets.size();
  rows->residuals.conservativeResize(num_rows + num_prior);
  rows->jacobian.conservativeResize(num_rows + num_prior, Eigen::NoChange);
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double root = std::sqrt(weights[i]);
    rows->residuals.segment(i * block_size, block_size) *= root;
    rows->jacobian.middleRows(i * block_size, block_size) *= root;
  }
  const double prior = scale / kTargetStddev;
  rows->residuals.tail(num_prior) = prior * targets.reshaped();
  rows->jacobian.bottomRows(num_prior).setZero();
  rows->jacobian.block(num_rows, target_column, num_prior, num_prior)
      .diagonal()
      .setConstant(prior);
}

Eigen::VectorXd FitStep(const FitRows& rows, double damping) {
  const Eigen::Index num_unknowns = rows.jacobian.cols();
  const Eigen::Index num_rows = rows.jacobian.rows();
  Eigen::MatrixXd matrix(num_rows + num_unknowns, num_unknowns);
  const double largest = rows.jacobian.colwise().norm().maxCoeff();
  matrix.topRows(num_rows) = rows.jacobian;
  matrix.bottomRows(num_unknowns).setZero();
  matrix.bottomRows(num_unknowns)
      .diagonal()
      .setConstant(std::sqrt(damping) * largest);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix.rows());
  right.head(num_rows) = -rows.residuals;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  // Well below the prior's 2e-6 even with 1e4 observations.
  decomposition.setThreshold(1e-10);
  decomposition.compute(matrix);
  return decomposition.solve(right);
}

}  // namespace alidade::internal
