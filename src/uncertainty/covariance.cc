#include "src/uncertainty/covariance.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "src/common/constants.h"
#include "src/common/svd.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/partition.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

// Up to this condition a triangle's inverse is good to ten digits.
constexpr double kGoodCondition = 1e6;
constexpr double kRankTolerance = 1e-12;
// Rounding leaves this much of a direction in parameters it has no part in.
constexpr double kNoPart = 1e-6;
// And of a direction in rows that do not see it.
constexpr double kNotSeen = 1e-6;
// Fewer degrees of freedom than these determine no scale of residuals.
constexpr double kFewestForScale = 5.0;

// Data and priors, one below the other, columns divided by `norms`.
Eigen::MatrixXd Stack(const Eigen::MatrixXd& factor,
                      const Eigen::VectorXd& prior, Eigen::VectorXd* norms) {
  const Eigen::Index p = factor.cols();
  Eigen::MatrixXd stacked(factor.rows() + p, p);
  stacked.topRows(factor.rows()) = factor;
  stacked.bottomRows(p) = prior.cwiseInverse().asDiagonal();
  *norms = stacked.colwise().norm();
  for (double& norm : *norms) norm = norm > 0.0 ? norm : 1.0;
  stacked *= norms->cwiseInverse().asDiagonal();
  return stacked;
}

// False where the triangle is too ill-conditioned.
bool InvertTriangle(const Eigen::MatrixXd& stacked, Eigen::MatrixXd* inverse) {
  const Eigen::Index p = stacked.cols();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(stacked);
  const Eigen::MatrixXd triangle =
      qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  inverse->setIdentity(p, p);
  triangle.triangularView<Eigen::Upper>().solveInPlace(*inverse);
  return triangle.norm() * inverse->norm() <= kGoodCondition;
}

void InvertBySvd(const Eigen::MatrixXd& stacked, const Eigen::VectorXd& norms,
                 ParameterCovariance* covariance) {
  const Svd svd = ComputeSvd(stacked);
  const auto rank = static_cast<Eigen::Index>(
      (svd.values.array() > kRankTolerance * svd.values[0]).count());
  const Eigen::Index p = stacked.cols();
  covariance->root = Eigen::MatrixXd::Zero(p, p);
  covariance->root.leftCols(rank) =
      norms.cwiseInverse().asDiagonal() * svd.v.leftCols(rank) *
      svd.values.head(rank).cwiseInverse().asDiagonal();
  const Eigen::MatrixXd null_space = svd.v.rightCols(p - rank);
  covariance->null_space = norms.cwiseInverse().asDiagonal() * null_space;
  for (int k = 0; k < p && rank < p; ++k) {
    if (null_space.row(k).norm() > kNoPart) {
      covariance->null_space_parameters.push_back(k);
    }
  }
}

// Means over all observations of what a robust loss makes of their residuals.
struct LossMoments {
  double weight_sum = 0.0;      // of d w + 2 w' s
  double weight_squares = 0.0;  // of the squares of (d w + 2 w' s) / d
  double influence = 0.0;       // of w^2 s
  double rows = 0.0;            // of d
  double observations = 0.0;
};

// Of the global data set.
LossMoments MomentsOf(const FittedProblem& fit) {
  struct Entry {
    double squared_norm;
    int dimension;
  };
  const SharedVector squared =
      SquaredNorms(fit.model.Errors(fit.values, fit.data), fit.data);
  std::vector<std::vector<Entry>> entries(fit.data.blocks.size());
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const ObservationBlock& block = fit.data.blocks[k];
    for (Eigen::Index i = 0; i < block.size(); ++i, ++count) {
      const int d = block.Dimension(i);
      if (d > 0) entries[k].push_back({squared[count], d});
    }
  }
  const std::vector<Entry> all =
      InOrder(fit.model.communicator(), fit.data, std::move(entries));
  return ComputeOnRoot(fit.model.communicator(), fit.data, [&] {
    LossMoments moments;
    for (const auto& [squared_norm, d] : all) {
      std::array<double, 3> rho{};
      fit.losses[d - 1].Evaluate(squared_norm, rho.data());
      const double pull = d * rho[1] + 2.0 * rho[2] * squared_norm;
      moments.weight_sum += pull;
      moments.weight_squares += pull * pull / (d * d);
      moments.influence += rho[1] * rho[1] * squared_norm;
      moments.rows += d;
      moments.observations += 1.0;
    }
    return moments;
  });
}

// A^-1 B^(1/2) from R and the factors a and K^2 b.
Eigen::MatrixXd SandwichRoot(const Eigen::MatrixXd& factor,
                             const Eigen::VectorXd& prior, double a, double b) {
  const ParameterCovariance bread =
      InverseInformation(std::sqrt(a) * factor, {}, prior);
  const Eigen::Index p = factor.cols();
  Eigen::MatrixXd filling(factor.rows() + p, p);
  filling.topRows(factor.rows()) = std::sqrt(b) * factor;
  filling.bottomRows(p) = prior.cwiseInverse().asDiagonal();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(filling);
  const Eigen::MatrixXd triangle =
      qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  return bread.root * (bread.root.transpose() * triangle.transpose());
}

}  // namespace

bool ParameterCovariance::IsTold(int index) const {
  return std::find(null_space_parameters.begin(), null_space_parameters.end(),
                   index) == null_space_parameters.end();
}

bool ParameterCovariance::AreTold(
    const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
  if (null_space.cols() == 0) return true;
  // What would come of it if the parts of a direction did not cancel.
  const Eigen::RowVectorXd parts =
      rows.colwise().norm() * null_space.cwiseAbs();
  return (rows * null_space).norm() <= kNotSeen * parts.norm();
}

Eigen::MatrixXd ParameterCovariance::Matrix() const {
  Eigen::MatrixXd matrix = root * root.transpose();
  for (int k = 0; k < size(); ++k) {
    if (IsTold(k)) continue;
    matrix.row(k).setConstant(std::numeric_limits<double>::quiet_NaN());
    matrix.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  for (int k = 0; k < size(); ++k) {
    if (!IsTold(k)) matrix(k, k) = kInfinity;
  }
  return matrix;
}

Eigen::VectorXd ParameterCovariance::Deviations() const {
  Eigen::VectorXd deviations = root.rowwise().norm();
  for (int k = 0; k < size(); ++k) {
    if (!IsTold(k)) deviations[k] = kInfinity;
  }
  return deviations;
}

ParameterCovariance InverseInformation(const Eigen::MatrixXd& whitened_factor,
                                       const std::vector<int>& columns,
                                       const Eigen::VectorXd& prior) {
  ParameterCovariance covariance;
  covariance.columns = columns;
  if (whitened_factor.cols() == 0) return covariance;
  Eigen::VectorXd norms;
  const Eigen::MatrixXd stacked = Stack(whitened_factor, prior, &norms);
  if (InvertTriangle(stacked, &covariance.root)) {
    covariance.root = norms.cwiseInverse().asDiagonal() * covariance.root;
  } else {
    InvertBySvd(stacked, norms, &covariance);
  }
  return covariance;
}

ParameterCovariance CovarianceOf(const FittedProblem& fit) {
  const Eigen::MatrixXd factor =
      JacobianFactor(fit.model, fit.values, fit.data, fit.free_columns);
  const Eigen::VectorXd prior = FreePriors(fit);
  ParameterCovariance covariance =
      InverseInformation(factor, fit.free_columns, prior);
  if (fit.losses.empty() || covariance.size() == 0) return covariance;
  const LossMoments moments = MomentsOf(fit);
  const double p = EffectiveParameters(covariance, prior);
  const double freedom = moments.rows - p;
  if (freedom < kFewestForScale) return covariance;
  const double a = moments.weight_sum / moments.rows;
  const double variance =
      std::max(0.0, moments.weight_squares / moments.observations - a * a);
  const double k = 1.0 + p / moments.rows * variance / (a * a);
  if (!(a > 0.0)) return covariance;
  covariance.root =
      SandwichRoot(factor, prior, a, k * k * moments.influence / freedom);
  covariance.degrees_of_freedom = freedom;
  covariance.is_sandwich = true;
  return covariance;
}

void AddTerms(std::shared_ptr<const TermCovariance> terms,
              ParameterCovariance* covariance) {
  const auto p = static_cast<Eigen::Index>(covariance->columns.size());
  const Eigen::MatrixXd rows = kTermUnit * terms->root.topRows(p);
  covariance->root = Eigen::MatrixXd(rows * rows.transpose()).llt().matrixL();
  covariance->null_space.resize(p, 0);
  covariance->null_space_parameters.clear();
  covariance->is_sandwich = false;
  covariance->terms = std::move(terms);
}

Eigen::VectorXd FreePriors(const FittedProblem& fit) {
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(fit.free_columns.size()), kInfinity);
  if (fit.priors.size() == 0) return prior;
  for (Eigen::Index k = 0; k < prior.size(); ++k) {
    const double value = fit.priors[fit.free_columns[k]];
    if (std::isfinite(value)) prior[k] = value;
  }
  return prior;
}

double EffectiveParameters(const ParameterCovariance& covariance,
                           const Eigen::VectorXd& prior) {
  const Eigen::VectorXd deviations = covariance.Deviations();
  auto effective = -static_cast<double>(covariance.null_space.cols());
  for (int k = 0; k < covariance.size(); ++k) {
    const double share = std::isfinite(prior[k]) ? deviations[k] / prior[k] : 0;
    effective += 1.0 - share * share;
  }
  return effective;
}

}  // namespace alidade::internal
