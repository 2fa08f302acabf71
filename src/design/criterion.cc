#include "alidade/design/criterion.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace alidade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Powers by which what is near the extreme counts in a slope.
constexpr double kEigenvaluePower = 4.0;
constexpr double kVariancePower = 12.0;

using Eigensystem = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

// Of eigenvalues in ascending order.
double SpectralValue(DesignCriterion criterion,
                     const Eigen::VectorXd& eigenvalues) {
  const Eigen::Index last = eigenvalues.size() - 1;
  if (!(eigenvalues[0] > 0.0)) return -kInfinity;
  const double smallest = std::log(eigenvalues[0]);
  const double largest = std::log(eigenvalues[last]);
  switch (criterion) {
    case DesignCriterion::kO2:
      return 0.5 * (smallest - largest);
    case DesignCriterion::kO3:
      return 0.5 * smallest;
    case DesignCriterion::kO4:
      return smallest - 0.5 * largest;
    case DesignCriterion::kO5:
      return -std::log(eigenvalues.array().rsqrt().sum());
    default:
      return smallest;
  }
}

// trace W_x M^-1 W_x^T of every place, M = L L^T.
Eigen::VectorXd RegionVariances(const Eigen::LLT<Eigen::MatrixXd>& cholesky,
                                const PoseRows& region) {
  const Eigen::MatrixXd solved = cholesky.matrixL().solve(region.transposed);
  const Eigen::VectorXd rows = solved.colwise().squaredNorm();
  return Eigen::Map<const Eigen::MatrixXd>(rows.data(), region.rows_each,
                                           region.size())
      .colwise()
      .sum();
}

// sum_x weights_x W_x^T W_x.
Eigen::MatrixXd WeightedMoment(const PoseRows& region,
                               const Eigen::VectorXd& weights) {
  const Eigen::Index p = region.num_parameters();
  Eigen::MatrixXd scaled = region.transposed;
  for (int x = 0; x < region.size(); ++x) {
    scaled.middleCols(Eigen::Index{region.rows_each} * x, region.rows_each) *=
        std::sqrt(weights[x]);
  }
  Eigen::MatrixXd moment = Eigen::MatrixXd::Zero(p, p);
  moment.selfadjointView<Eigen::Lower>().rankUpdate(scaled);
  return moment.selfadjointView<Eigen::Lower>();
}

// A root F of a matrix that may be singular: F F^T.
Eigen::MatrixXd RootOf(const Eigen::MatrixXd& matrix) {
  const Eigensystem eigen(matrix);
  return eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

DesignSlope PredictionSlope(DesignCriterion criterion,
                            const Eigen::MatrixXd& information,
                            const PoseRows& region) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  const Eigen::VectorXd variances = RegionVariances(cholesky, region);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(region.size());
  if (criterion == DesignCriterion::kG) {
    weights = (variances / variances.maxCoeff()).array().pow(kVariancePower);
  }
  const Eigen::MatrixXd moment = WeightedMoment(region, weights);
  return {cholesky.solve(RootOf(moment)),
          Eigen::VectorXd::Ones(information.rows())};
}

// d log l_p, softly: the smaller an eigenvalue, the more.
Eigen::ArrayXd SmallestSlope(const Eigen::ArrayXd& eigenvalues) {
  return (eigenvalues[0] / eigenvalues).pow(kEigenvaluePower) / eigenvalues;
}

Eigen::ArrayXd LargestSlope(const Eigen::ArrayXd& eigenvalues) {
  const double largest = eigenvalues[eigenvalues.size() - 1];
  return (eigenvalues / largest).pow(kEigenvaluePower) / eigenvalues;
}

Eigen::VectorXd SpectralSlope(DesignCriterion criterion,
                              const Eigen::ArrayXd& eigenvalues) {
  switch (criterion) {
    case DesignCriterion::kA:
      return eigenvalues.pow(-2.0);
    case DesignCriterion::kO5:
      return eigenvalues.pow(-1.5);
    case DesignCriterion::kO2:
      return SmallestSlope(eigenvalues) - LargestSlope(eigenvalues);
    case DesignCriterion::kO4:
      return 2.0 * SmallestSlope(eigenvalues) - LargestSlope(eigenvalues);
    default:
      return SmallestSlope(eigenvalues);
  }
}

}  // namespace

double CriterionValue(DesignCriterion criterion,
                      const Eigen::MatrixXd& information,
                      const PoseRows& region) {
  if (criterion == DesignCriterion::kE || criterion == DesignCriterion::kO2 ||
      criterion == DesignCriterion::kO3 || criterion == DesignCriterion::kO4 ||
      criterion == DesignCriterion::kO5) {
    const Eigensystem eigen(information, Eigen::EigenvaluesOnly);
    return SpectralValue(criterion, eigen.eigenvalues());
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  if (cholesky.info() != Eigen::Success) return -kInfinity;
  const auto p = static_cast<double>(information.rows());
  if (criterion == DesignCriterion::kD) {
    return 2.0 / p * cholesky.matrixLLT().diagonal().array().log().sum();
  }
  if (criterion == DesignCriterion::kA) {
    const Eigen::MatrixXd inverse_root = cholesky.matrixL().solve(
        Eigen::MatrixXd::Identity(information.rows(), information.rows()));
    return -std::log(inverse_root.squaredNorm());
  }
  const Eigen::VectorXd variances = RegionVariances(cholesky, region);
  return -std::log(criterion == DesignCriterion::kG ? variances.maxCoeff()
                                                    : variances.mean());
}

DesignSlope SlopeOf(DesignCriterion criterion,
                    const Eigen::MatrixXd& information,
                    const PoseRows& region) {
  if (NeedsRegion(criterion)) {
    return PredictionSlope(criterion, information, region);
  }
  const Eigensystem eigen(information);
  const double floor = 1e-300;
  return {eigen.eigenvectors(),
          SpectralSlope(criterion, eigen.eigenvalues().array().max(floor))};
}

}  // namespace alidade
