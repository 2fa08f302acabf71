#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "src/solve/compressed_solver.h"
#include "src/solve/formulation.h"
#include "src/solve/progress.h"
#include "src/solve/solver.h"

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
      : formulation_(formulation), progress_(progress) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0) return ceres::SOLVER_CONTINUE;
    IterationStep step;
    step.norm = iteration.step_norm;
    step.accepted = iteration.step_is_successful;
    step.predicted_decrease = PredictedDecrease(iteration);
    return progress_->Record(step, formulation_.Values())
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Formulation& formulation_;
  Progress* progress_;
};

ceres::Solver::Options CeresOptions(const SolverOptions& options,
                                    double radius) {
  ceres::Solver::Options ceres_options;
  ceres_options.minimizer_type = ceres::TRUST_REGION;
  ceres_options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  ceres_options.linear_solver_type = ceres::DENSE_QR;
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
    progress->Stop(SolverStatus::kConverged, ceres_summary.message);
  } else {
    progress->Stop(SolverStatus::kFailed,
                   "Ceres: " + ceres_summary.message +
                       " Look for poses or units that are wrong, or fix what "
                       "the identifiability pass calls weak");
  }
}

// Ceres over `formulation`, until the shared rules or Ceres end it.
void IterateCeres(const CalibrationProblem& problem,
                  const SolverOptions& options, double radius,
                  Formulation* formulation, Progress* progress) {
  ceres::Solver::Options ceres_options = CeresOptions(options, radius);
  // Steps that end at a bound keep promising what lies beyond it.
  if (problem.lower.size() > 0) {
    constexpr double kNoChange = 1e-13;
    ceres_options.function_tolerance = kNoChange;
    ceres_options.parameter_tolerance = kNoChange;
  }
  StoppingRules stopping_rules(*formulation, progress);
  ceres_options.callbacks.push_back(&stopping_rules);
  ceres::Solver::Summary ceres_summary;
  ceres::Solve(ceres_options, formulation->problem(), &ceres_summary);
  ExplainTermination(ceres_summary, progress);
}

}  // namespace

SolverSummary SolveLevenbergMarquardt(const CalibrationProblem& problem,
                                      const SolverOptions& options,
                                      Eigen::VectorXd* values) {
  const bool compressed = options.evaluation != Evaluation::kAutodiff;
  const bool needs_ceres = !compressed || problem.lower.size() > 0;
  Progress progress(problem, options, "ceres");
  Eigen::VectorXd current = *values;
  CompressedProblem start;
  if (progress.Start(current, needs_ceres ? nullptr : &start)) {
    const double given = options.initial_trust_region_radius;
    const double radius =
        given > 0.0 ? given : ChooseTrustRegionRadius(problem.start_rank);
    std::unique_ptr<Formulation> formulation;
    if (!compressed) {
      formulation = MakeAutodiffFormulation(problem, current);
    } else if (needs_ceres) {
      formulation =
          MakeCompressedFormulation(problem, current, progress.compressor());
    }
    progress.summary().evaluation = compressed ? "compressed" : "autodiff";
    progress.summary().trust_region_used = radius;
    progress.summary().setup_time_s = progress.stopwatch().Seconds();
    if (needs_ceres) {
      IterateCeres(problem, options, radius, formulation.get(), &progress);
      current = formulation->Values();
    } else {
      IterateLevenbergMarquardt(problem, radius, &start, &progress, &current);
    }
  }
  progress.Finish();
  if (progress.summary().IsSolutionUsable()) *values = current;
  return progress.summary();
}

}  // namespace alidade::internal
