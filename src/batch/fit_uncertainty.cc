#include "fit_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "alidade/measurement/robust_loss.h"

namespace alidade {
namespace {

// Profiles ask for a dozen solves of each parameter: more observations than
// this make the model straight anyway.
constexpr Eigen::Index kMostForProfiles = 100000;

// What the prior of a held parameter adds: the solver counts those of free ones
// alone.
double PriorCost(const CalibrationProblem& problem, int column,
                 const Eigen::VectorXd& values) {
  if (column < 0 || problem.priors.size() == 0) return 0.0;
  if (!std::isfinite(problem.priors[column])) return 0.0;
  const double nominal = problem.model.NominalValues()[column];
  const double deviation = (values[column] - nominal) / problem.priors[column];
  return deviation * deviation;
}

}  // namespace

Resolve ResolveByCeres(const CalibrationProblem& problem,
                       const SolverOptions& options) {
  SolverOptions quiet = options;
  quiet.on_iteration = {};
  return [&problem, quiet](int fixed_column,
                           Eigen::VectorXd* values) -> std::optional<double> {
    CalibrationProblem rest = problem;
    std::vector<int>& free = rest.free_columns;
    free.erase(std::remove(free.begin(), free.end(), fixed_column), free.end());
    rest.start_rank = {};
    const SolverSummary summary = SolveLevenbergMarquardt(rest, quiet, values);
    if (!summary.IsSolutionUsable()) return std::nullopt;
    return summary.final_cost + PriorCost(problem, fixed_column, *values);
  };
}

UncertaintyResult AssessFit(const FinishedFit& fit, double final_cost) {
  CalibrationProblem problem = fit.problem;
  problem.losses = TunedLosses(fit.config.loss);
  AssessmentInput input{{fit.model(), fit.config.data, problem.free_columns,
                         problem.priors, problem.losses, fit.values},
                        fit.config.uncertainty};
  input.sigma_estimated = fit.config.estimate_sigma;
  if (fit.config.solver == SolverName::kCeres &&
      fit.config.data.all_observations() <= kMostForProfiles) {
    input.fit_cost = final_cost;
    input.resolve = ResolveByCeres(problem, fit.config.solver_options);
  }
  if (fit.config.validation) input.heldout = &*fit.config.validation;
  if (fit.config.truth) input.true_values = *fit.config.truth;
  return AssessUncertainty(input);
}

}  // namespace alidade
