#include "src/simulation/repeated_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"

namespace alidade::internal {
namespace {

// Equations less what the fit takes of them.
double Freedom(const Dataset& data, const ParameterCovariance& covariance,
               const Eigen::VectorXd& prior) {
  return static_cast<double>(data.num_equations()) -
         EffectiveParameters(covariance, prior);
}

void ScaleSigmas(double factor, Dataset* data) {
  for (ObservationBlock& block : data->blocks) {
    block.sigmas = block.sigmas.map() * factor;
    for (Eigen::MatrixXd& whitener : block.whiteners) whitener /= factor;
  }
}

}  // namespace

RepeatedCalibration::RepeatedCalibration(const MeasurementModel& model,
                                         const IdentifiabilityResult& pass,
                                         Options options)
    : model_(model),
      free_columns_(FreeColumns(pass)),
      start_rank_(pass.nominal_rank),
      priors_(PriorsOf(pass)),
      options_(std::move(options)),
      losses_(TunedLosses(options_.loss)) {}

CalibrationProblem RepeatedCalibration::ProblemOf(const Dataset& data) const {
  CalibrationProblem problem{model_, data, free_columns_, start_rank_, priors_};
  problem.losses = losses_;
  return problem;
}

void RepeatedCalibration::Assess(const Dataset& data, Outcome* outcome) const {
  const FittedProblem fit{model_,  data,    free_columns_,
                          priors_, losses_, outcome->values};
  outcome->covariance = CovarianceOf(fit);
  const double freedom = Freedom(data, outcome->covariance, FreePriors(fit));
  if (freedom < 1.0) return;
  outcome->reduced_chi_square =
      ChiSquare(model_.Errors(outcome->values, data), data) / freedom;
  if (options_.estimate_sigma) outcome->covariance.degrees_of_freedom = freedom;
}

RepeatedCalibration::Outcome RepeatedCalibration::Run(
    const Dataset& data) const {
  Outcome outcome;
  outcome.values = model_.NominalValues();
  CalibrationProblem problem = ProblemOf(data);
  const SolverSummary summary =
      SolveRobust(problem, options_.loss, options_.solver, &outcome.values);
  if (!summary.IsSolutionUsable()) return outcome;
  outcome.is_usable = true;
  outcome.cost = summary.final_cost;
  Assess(data, &outcome);
  if (!options_.estimate_sigma || !(outcome.reduced_chi_square > 0.0)) {
    return outcome;
  }
  outcome.sigma_factor = std::sqrt(outcome.reduced_chi_square);
  if (problem.ColumnsWithPrior().empty()) {
    // The solution does not depend on sigma.
    outcome.covariance.root *= outcome.sigma_factor;
    return outcome;
  }
  Dataset scaled = data;
  ScaleSigmas(outcome.sigma_factor, &scaled);
  const SolverSummary again = SolveRobust(ProblemOf(scaled), options_.loss,
                                          options_.solver, &outcome.values);
  outcome.is_usable = again.IsSolutionUsable();
  outcome.cost = again.final_cost;
  Assess(scaled, &outcome);
  return outcome;
}

}  // namespace alidade::internal
