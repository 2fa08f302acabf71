#include "src/planning/criterion.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "src/common/constants.h"

namespace alidade::internal {
namespace {

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

bool IsSpectral(DesignCriterion criterion) {
  switch (criterion) {
    case DesignCriterion::kE:
    case DesignCriterion::kO2:
    case DesignCriterion::kO3:
    case DesignCriterion::kO4:
    case DesignCriterion::kO5:
      return true;
    default:
      return false;
  }
}

// What the rows of each place add up to.
Eigen::VectorXd SumsOfRows(const Eigen::VectorXd& rows, int rows_each) {
  return Eigen::Map<const Eigen::MatrixXd>(rows.data(), rows_each,
                                           rows.size() / rows_each)
      .colwise()
      .sum();
}

// trace W_x M^-1 W_x^T of every place, M = L L^T.
Eigen::VectorXd RegionVariances(const Eigen::LLT<Eigen::MatrixXd>& cholesky,
                                const PoseRows& region) {
  const Eigen::MatrixXd solved = cholesky.matrixL().solve(region.transposed);
  return SumsOfRows(solved.colwise().squaredNorm(), region.rows_each);
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
  return CriterionEvaluator(criterion, region).Value(information);
}

DesignSlope SlopeOf(DesignCriterion criterion,
                    const Eigen::MatrixXd& information,
                    const PoseRows& region) {
  return CriterionEvaluator(criterion, region).Slope(information);
}

CriterionEvaluator::CriterionEvaluator(DesignCriterion criterion,
                                       const PoseRows& region)
    : criterion_(criterion), region_(region) {
  if (criterion != DesignCriterion::kI) return;
  moment_ = WeightedMoment(
      region, Eigen::VectorXd::Constant(region.size(), 1.0 / region.size()));
  moment_root_ = RootOf(moment_);
}

double CriterionEvaluator::Value(const Eigen::MatrixXd& information) const {
  if (IsSpectral(criterion_)) {
    const Eigensystem eigen(information, Eigen::EigenvaluesOnly);
    return SpectralValue(criterion_, eigen.eigenvalues());
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  if (cholesky.info() != Eigen::Success) return -kInfinity;
  const Eigen::Index p = information.rows();
  switch (criterion_) {
    case DesignCriterion::kA:
      return -std::log(Eigen::MatrixXd(cholesky.matrixL().solve(
                                           Eigen::MatrixXd::Identity(p, p)))
                           .squaredNorm());
    case DesignCriterion::kI:
      return -std::log(Eigen::MatrixXd(cholesky.matrixL().solve(moment_root_))
                           .squaredNorm());
    case DesignCriterion::kG:
      return -std::log(RegionVariances(cholesky, region_).maxCoeff());
    default:
      return 2.0 / static_cast<double>(p) *
             cholesky.matrixLLT().diagonal().array().log().sum();
  }
}

DesignSlope CriterionEvaluator::Slope(
    const Eigen::MatrixXd& information) const {
  if (!NeedsRegion(criterion_)) {
    const Eigensystem eigen(information);
    constexpr double kFloor = 1e-300;
    return {eigen.eigenvectors(),
            SpectralSlope(criterion_, eigen.eigenvalues().array().max(kFloor))};
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(information.rows());
  if (criterion_ == DesignCriterion::kI) {
    return {cholesky.solve(moment_root_), ones};
  }
  const Eigen::VectorXd variances = RegionVariances(cholesky, region_);
  const Eigen::VectorXd weights =
      (variances / variances.maxCoeff()).array().pow(kVariancePower);
  return {cholesky.solve(RootOf(WeightedMoment(region_, weights))), ones};
}

void CriterionEvaluator::SetBase(const Eigen::MatrixXd& information) {
  base_ = information;
  if (criterion_ != DesignCriterion::kG) return;
  const Eigen::Index p = information.rows();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  // Where a pose is needed to determine all parameters, an update would lose
  // digits.
  constexpr double kRegular = 1e-6;
  base_is_regular_ =
      cholesky.info() == Eigen::Success && cholesky.rcond() > kRegular;
  if (!base_is_regular_) return;
  base_inverse_ = cholesky.solve(Eigen::MatrixXd::Identity(p, p));
  base_variances_ = RegionVariances(cholesky, region_);
}

double CriterionEvaluator::ValueWith(const Eigen::MatrixXd& pose) const {
  if (criterion_ == DesignCriterion::kG && base_is_regular_) {
    return -std::log(WorstWith(pose));
  }
  return Value(base_ + pose * pose.transpose());
}

// W (M + J^T J)^-1 W^T = W M^-1 W^T - (W U)(W U)^T, U as in exchange.h.
double CriterionEvaluator::WorstWith(const Eigen::MatrixXd& pose) const {
  const Eigen::MatrixXd solved = base_inverse_ * pose;
  Eigen::MatrixXd middle = pose.transpose() * solved;
  middle.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(middle);
  const Eigen::MatrixXd update = cholesky.matrixL().solve(solved.transpose());
  const Eigen::VectorXd rows =
      (update * region_.transposed).colwise().squaredNorm();
  return (base_variances_ - SumsOfRows(rows, region_.rows_each)).maxCoeff();
}

}  // namespace alidade::internal
