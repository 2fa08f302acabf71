#include "src/calibration/distance_sigma.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "alidade/robust_loss.h"
#include "src/calibration/sigma_change.h"
#include "src/common/constants.h"
#include "src/kernel/partition.h"
#include "src/kernel/reduction.h"

namespace alidade::internal {
namespace {

bool IsDistance(const ObservationBlock& block) {
  return block.kind == MeasurementKind::kPointDistance;
}

// The data with the known distances alone measured, or with all but these.
Dataset Part(const Dataset& data, bool distances) {
  Dataset part = data;
  for (ObservationBlock& block : part.blocks) {
    if (IsDistance(block) == distances) continue;
    block.whiteners.clear();
    block.sigmas = Eigen::MatrixXd::Constant(block.sigmas.rows(),
                                             block.sigmas.cols(), kInfinity);
  }
  return part;
}

// The smallest sigma of the distances; infinite where none is known.
double LeastSigma(const Dataset& data) {
  double least = kInfinity;
  for (const ObservationBlock& block : data.blocks) {
    if (!IsDistance(block) || block.size() == 0) continue;
    least = std::min(least, block.sigmas.map().minCoeff());
  }
  return least;
}

// What some observations say of the parameters' changes.
struct Evidence {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double cost = 0.0;
};

Evidence EvidenceOf(const CalibrationProblem& problem,
                    const Eigen::VectorXd& values, const Dataset& data,
                    const std::vector<RobustLoss>& losses) {
  ReducedLeastSquares reduced;
  Reducer(problem.model, data, problem.free_columns, losses)
      .Reduce(values, &reduced);
  return {reduced.factor.transpose() * reduced.factor,
          reduced.factor.transpose() * reduced.projected, reduced.cost};
}

void AddPriors(const CalibrationProblem& problem, const Eigen::VectorXd& values,
               Evidence* evidence) {
  const Eigen::VectorXd nominal = problem.model.NominalValues();
  for (std::size_t k = 0; k < problem.free_columns.size(); ++k) {
    const int column = problem.free_columns[k];
    if (problem.priors.size() == 0) return;
    const double prior = problem.priors[column];
    if (!std::isfinite(prior)) continue;
    const double precision = 1.0 / (prior * prior);
    const auto row = static_cast<Eigen::Index>(k);
    evidence->information(row, row) += precision;
    evidence->gradient[row] += precision * (values[column] - nominal[column]);
  }
}

// -2 log p, but for a constant.
double Unlikelihood(const Evidence& others, const Evidence& distances,
                    double count, double factor) {
  const double w = 1.0 / (factor * factor);
  Eigen::MatrixXd information = others.information + w * distances.information;
  const Eigen::VectorXd gradient = others.gradient + w * distances.gradient;
  // Angles and lengths differ in size.
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  information = inverse.asDiagonal() * information * inverse.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  if (!solver.isPositive()) return kInfinity;
  const Eigen::VectorXd b = inverse.cwiseProduct(gradient);
  return -count * std::log(w) + solver.vectorD().array().abs().log().sum() +
         2.0 * scale.array().log().sum() + w * distances.cost -
         b.dot(solver.solve(b));
}

}  // namespace

double EstimateDistanceFactor(const CalibrationTask& task,
                              const MeasurementModel& model, const Fit& fit) {
  constexpr double kStep = 1.1;
  constexpr double kByChance = 10.0;
  const Dataset& data = task.data.training;
  const Dataset known = Part(data, true);
  const auto count =
      static_cast<double>(GlobalEquations(task.communicator, known));
  if (count == 0.0) return 1.0;
  const CalibrationProblem problem =
      ProblemOf(task, model, fit.identifiability);
  Evidence others = EvidenceOf(problem, fit.values, Part(data, false),
                               TunedLosses(task.options.loss));
  AddPriors(problem, fit.values, &others);
  const Evidence distances = EvidenceOf(problem, fit.values, known, {});
  const double most = std::sqrt(2.0) *
                      MedianSigma(RowClass::kLength, data, task.communicator) /
                      LeastSigma(data);
  const double as_stated = Unlikelihood(others, distances, count, 1.0);
  double best = 1.0;
  double least = as_stated - kByChance;
  double factor = kStep;
  while (factor <= most) {
    const double unlikelihood = Unlikelihood(others, distances, count, factor);
    if (unlikelihood < least) {
      least = unlikelihood;
      best = factor;
    }
    factor *= kStep;
  }
  return best;
}

void ScaleDistanceSigmas(double factor, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    if (!IsDistance(block)) continue;
    block.sigmas = Eigen::MatrixXd(factor * block.sigmas.map());
  }
}

}  // namespace alidade::internal
