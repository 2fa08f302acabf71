#include "src/calibration/fit_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "alidade/robust_loss.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
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

// A fixed parameter and those that it depends on, moved so that no measured
// quantity changes: 1 and what its relation takes back.
Eigen::VectorXd DirectionOf(const Relation& relation,
                            const ParameterLayout& layout) {
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(layout.size());
  direction[*layout.Find(relation.parameter)] = 1.0;
  for (const auto& [name, coefficient] : relation.terms) {
    direction[*layout.Find(name)] -= coefficient;
  }
  return direction;
}

// Fixed parameters that nothing measured could determine, but that move
// positions, within what is known of them beforehand by `counts` (m, root mean
// square) or more: of one axis or of distances there are some.
std::string FixedThatMovePositions(const MeasurementModel& model,
                                   const IdentifiabilityResult& pass,
                                   const PriorTolerances& priors,
                                   double counts) {
  constexpr int kPoses = 50;
  // Relations leave small coefficients out.
  constexpr double kLeftOut = 1e-3;
  constexpr double kRounding = 1e-6;
  const ParameterLayout& layout = model.layout();
  const Eigen::MatrixXd joints = DrawJointValues(model.nominal(), kPoses, 1);
  const Dataset positions =
      MakePositions(joints, Eigen::Matrix3Xd::Zero(3, kPoses),
                    Eigen::Matrix3Xd::Ones(3, kPoses));
  std::vector<int> all(layout.size());
  std::iota(all.begin(), all.end(), 0);
  Linearization rows;
  model.Linearize(model.NominalValues(), positions, all, &rows);
  const Eigen::VectorXd norms = rows.jacobian.colwise().norm();
  std::string names;
  for (const Relation& relation : pass.relations) {
    const int column = *layout.Find(relation.parameter);
    const ParameterDecision& decision = pass.decisions[column];
    if (decision.state != ParameterState::kFixed ||
        decision.rule == "fixed_by_user") {
      continue;
    }
    const Eigen::VectorXd direction = DirectionOf(relation, layout);
    // Beside what its parts do, or, where they do nothing, what others do.
    const double parts =
        std::max(norms.dot(direction.cwiseAbs()), kRounding * norms.maxCoeff());
    const double moved = (rows.jacobian * direction).norm();
    const double prior = priors.Of(layout.parameter(column).kind);
    if (moved <= kLeftOut * parts ||
        prior * moved <= counts * std::sqrt(static_cast<double>(kPoses))) {
      continue;
    }
    names += (names.empty() ? "" : ", ") + relation.parameter;
  }
  return names;
}

void WarnOfWhatIsNotMeasured(const CalibrationSolution& fit,
                             const IdentifiabilityResult& pass,
                             UncertaintyResult* result) {
  // Less would not show beside what is predicted.
  constexpr double kShows = 0.3;
  const double predicted =
      result->workspace ? result->workspace->summary.rms : 0.0;
  const std::string names = FixedThatMovePositions(
      fit.model(), pass, fit.task.options.identifiability.priors,
      kShows * predicted);
  if (names.empty()) return;
  result->warnings.push_back(
      "positions depend on what these measurements cannot determine (" + names +
      " fixed at nominal): predicted deviations are those of what was "
      "measured, and the whole position may be off by what these are");
}

// Why intervals cannot be those of the profile likelihood; empty where they
// can.
std::string ProfileObstacle(const CalibrationSolution& fit) {
  if (fit.terms) return "are made of fits without error terms alone";
  if (fit.task.options.solver != SolverName::kCeres) {
    return "need `solver: ceres`";
  }
  if (fit.task.data.training.global_observations() > kMostForProfiles) {
    return "are made of " + std::to_string(kMostForProfiles) +
           " observations at most";
  }
  return "";
}

}  // namespace

Resolve ResolveByCeres(const CalibrationProblem& problem,
                       const SolverOptions& options) {
  SolverOptions quiet = options;
  quiet.on_iteration = {};
  // Many solves of the same minimum: the faster formulation, whatever the
  // job's.
  quiet.evaluation = Evaluation::kReduced;
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

FitCovariance CovarianceOfFit(const CalibrationSolution& fit,
                              const NoiseKnowledge& noise) {
  const std::vector<RobustLoss> losses = TunedLosses(fit.task.options.loss);
  return CovarianceWithLack(
      {fit.model(), fit.task.data.training, fit.problem.free_columns,
       fit.problem.priors, losses, fit.values},
      noise, fit.terms);
}

UncertaintyResult AssessFit(const CalibrationSolution& fit,
                            const IdentifiabilityResult& pass,
                            double final_cost, const FitFindings& found) {
  CalibrationProblem problem = fit.problem;
  problem.losses = TunedLosses(fit.task.options.loss);
  AssessmentInput input{
      {fit.model(), fit.task.data.training, problem.free_columns,
       problem.priors, problem.losses, fit.values},
      found.covariance,
      fit.task.options.uncertainty};
  input.measurement = found.measurement;
  input.sigma_estimated = fit.task.options.estimate_sigma;
  input.no_profiles = ProfileObstacle(fit);
  if (input.no_profiles.empty()) {
    input.fit_cost = final_cost;
    input.resolve = ResolveByCeres(problem, fit.task.options.solver_options);
  }
  if (found.training.kept) input.kept = &*found.training.kept;
  if (found.validation.ordinary) {
    input.validation = &*found.validation.ordinary;
  } else if (fit.task.data.validation) {
    input.validation = &*fit.task.data.validation;
  }
  if (fit.task.options.true_values) {
    input.true_values = *fit.task.options.true_values;
  }
  UncertaintyResult result = AssessUncertainty(input);
  if (found.validation.ordinary) {
    result.validation->num_outliers = found.validation.num_outliers;
  }
  WarnOfWhatIsNotMeasured(fit, pass, &result);
  if (fit.task.options.uncertainty.intervals == IntervalMethod::kProfile &&
      !input.resolve) {
    result.warnings.push_back("intervals are linear: profiles " +
                              input.no_profiles);
  }
  return result;
}

}  // namespace alidade::internal
