#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "src/solve/bounded_solver.h"
#include "src/solve/formulation.h"
#include "src/solve/progress.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

// Levenberg-Marquardt adds 1 / sqrt(radius) to the singular values of a
// Jacobian with unit columns. A thirtieth of the smallest one that counts
// leaves the first steps those of Gauss-Newton in all directions that the rank
// counts, and damps those it does not, along which a step would be long and
// wild.
double ChooseTrustRegionRadius(const RankReport& start_rank) {
  constexpr double kCeresDefault = 1e4;
  const double damping = start_rank.SmallestCounted() / 30.0;
  return std::max(kCeresDefault, 1.0 / (damping * damping));
}

// What the linear model expected chi-square to lose, from what it lost and the
// ratio of the two.
double PredictedDecrease(const ceres::IterationSummary& iteration) {
  // An invalid step, with which Ceres deals by a smaller trust region, says
  // nothing: count it as large.
  if (!iteration.step_is_valid) return 2.0 * iteration.cost;
  // Nothing changed to the last bit: no step can be smaller.
  if (iteration.relative_decrease == 0.0) return 0.0;
  return 2.0 * iteration.cost_change / iteration.relative_decrease;
}

// Hands every iteration of Ceres to the shared stopping rules. Ceres' cost is
// half of chi-square, and so is its predicted decrease.
class StoppingRules : public ceres::IterationCallback {
 public:
  StoppingRules(const Formulation& formulation, Progress* progress)
      : formulation_(formulation),
        values_(formulation.Values()),
        progress_(progress) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0) return ceres::SOLVER_CONTINUE;
    IterationStep step;
    const Eigen::VectorXd before =
        std::exchange(values_, formulation_.Values());
    step.accepted = iteration.step_is_successful;
    // Before the first step that succeeds, Ceres 2.2 has no norm.
    step.norm = step.accepted ? (values_ - before).norm() : iteration.step_norm;
    step.predicted_decrease = PredictedDecrease(iteration);
    const std::optional<double> known = formulation_.PredictedDecrease();
    if (known && iteration.step_is_valid) step.predicted_decrease = *known;
    return progress_->Record(step, values_)
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Formulation& formulation_;
  Eigen::VectorXd values_;
  Progress* progress_;
};

ceres::Solver::Options CeresOptions(const SolverOptions& options,
                                    double radius) {
  ceres::Solver::Options ceres_options;
  ceres_options.minimizer_type = ceres::TRUST_REGION;
  ceres_options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  ceres_options.num_threads = 1;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.update_state_every_iteration = true;
  ceres_options.initial_trust_region_radius = radius;
  ceres_options.max_trust_region_radius =
      std::max(radius, ceres_options.max_trust_region_radius);
  ceres_options.max_num_iterations = options.max_iterations;
  // The shared rules stop the solve; Ceres' own would stop it by others.
  ceres_options.function_tolerance = 0.0;
  ceres_options.gradient_tolerance = 0.0;
  ceres_options.parameter_tolerance = 0.0;
  return ceres_options;
}

// Where Ceres ended without the shared rules having a word.
void ExplainTermination(const ceres::Solver::Summary& ceres_summary,
                        Progress* progress) {
  if (progress->stopped()) return;
  if (ceres_summary.termination_type == ceres::CONVERGENCE) {
    progress->Stop(SolverStatus::kConverged,
                   "no step changes the cost any more");
  } else {
    progress->Stop(SolverStatus::kFailed,
                   "Ceres: " + ceres_summary.message +
                       " Look for poses or units that are wrong, or fix what "
                       "the identifiability pass calls weak");
  }
}

// The largest cosine between the residuals and a column of the Jacobian that is
// not rounding.
double GradientCosine(const Eigen::VectorXd& values, Reducer* reducer) {
  ReducedLeastSquares reduced;
  reducer->Reduce(values, &reduced);
  const Eigen::VectorXd norms = reduced.factor.colwise().norm();
  const Eigen::VectorXd gradient =
      reduced.factor.transpose() * reduced.projected;
  double cosine = 0.0;
  for (Eigen::Index k = 0; k < norms.size(); ++k) {
    if (norms[k] <= kRoundingColumn * norms.maxCoeff()) continue;
    cosine = std::max(cosine, std::abs(gradient[k]) / norms[k]);
  }
  return reduced.cost > 0.0 ? cosine / std::sqrt(reduced.cost) : 0.0;
}

// A solve that no step was taken in is no solution unless it began at one.
void RequireStationary(const Eigen::VectorXd& values, Progress* progress) {
  constexpr double kNotStationary = 1e-3;
  if (progress->summary().status == SolverStatus::kConverged &&
      progress->summary().accepted_steps == 0 &&
      GradientCosine(values, progress->reducer()) > kNotStationary) {
    progress->Stop(SolverStatus::kFailed,
                   "no step lowers the cost, though it is no minimum: fix what "
                   "the identifiability pass calls weak");
  }
}

// Ceres over `formulation`, until the shared rules or Ceres end it.
void IterateCeres(const SolverOptions& options, double radius,
                  Formulation* formulation, Progress* progress) {
  ceres::Solver::Options ceres_options = CeresOptions(options, radius);
  ceres_options.linear_solver_type = formulation->linear_solver();
  StoppingRules stopping_rules(*formulation, progress);
  ceres_options.callbacks.push_back(&stopping_rules);
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(ceres_options, formulation->problem(), &ceres_summary);
  ExplainTermination(ceres_summary, progress);
}

SolverSummary SolveUnbounded(const CalibrationProblem& problem,
                             const SolverOptions& options,
                             Eigen::VectorXd* values) {
  const bool reduced = options.evaluation != Evaluation::kAutodiff;
  Progress progress(problem, options, "ceres");
  Eigen::VectorXd current = *values;
  ReducedLeastSquares start;
  if (progress.Start(current, reduced ? &start : nullptr)) {
    const double given = options.initial_trust_region_radius;
    const double radius =
        given > 0.0 ? given : ChooseTrustRegionRadius(problem.start_rank);
    const std::unique_ptr<Formulation> formulation =
        reduced ? MakeReducedFormulation(problem, current, std::move(start),
                                         &progress)
                : MakeAutodiffFormulation(problem, current);
    progress.summary().evaluation = reduced ? "reduced" : "autodiff";
    progress.summary().trust_region_used = radius;
    progress.summary().setup_time_s = progress.stopwatch().Seconds();
    IterateCeres(options, radius, formulation.get(), &progress);
    current = formulation->Values();
    RequireStationary(current, &progress);
  }
  progress.Finish();
  if (progress.summary().IsSolutionUsable()) *values = current;
  return progress.summary();
}

}  // namespace

SolverSummary SolveLevenbergMarquardt(const CalibrationProblem& problem,
                                      const SolverOptions& options,
                                      Eigen::VectorXd* values) {
  if (problem.lower.size() == 0) {
    return SolveUnbounded(problem, options, values);
  }
  Progress progress(problem, options, "ceres");
  if (!progress.Start(*values)) {
    progress.Finish();
    return progress.summary();
  }
  return SolveWithinBounds(problem, options, SolveUnbounded, values);
}

}  // namespace alidade::internal
