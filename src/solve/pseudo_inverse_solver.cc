#include <algorithm>
#include <vector>

#include "src/common/svd.h"
#include "src/solve/progress.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

// Singular values of later steps that are left to count: all but rounding.
// What second-order effects distinguish grows from zero as the geometry leaves
// its nominal values, so no fixed tolerance in the gap at the start would do.
constexpr double kLaterTolerance = 1e-12;

// The number of singular values that count at one step.
Eigen::Index CountedRank(const Eigen::VectorXd& singular_values,
                         double tolerance) {
  return (singular_values.array() > tolerance * singular_values[0]).count();
}

// The whitened poses, and below them a row (value - nominal) / prior for every
// free parameter that has one.
void LinearizeWithPriors(const CalibrationProblem& problem,
                         const Eigen::VectorXd& values, Linearization* out) {
  problem.model.Linearize(values, problem.data, problem.free_columns, out);
  const std::vector<int> with_prior = problem.ColumnsWithPrior();
  if (with_prior.empty()) return;
  const Eigen::VectorXd nominal = problem.model.NominalValues();
  const Eigen::Index first = out->jacobian.rows();
  const Eigen::Index rows =
      first + static_cast<Eigen::Index>(with_prior.size());
  out->jacobian.conservativeResize(rows, Eigen::NoChange);
  out->jacobian.bottomRows(rows - first).setZero();
  out->residuals.conservativeResize(rows);
  for (std::size_t k = 0; k < with_prior.size(); ++k) {
    const int column = with_prior[k];
    const Eigen::Index row = first + static_cast<Eigen::Index>(k);
    const auto position = std::lower_bound(problem.free_columns.begin(),
                                           problem.free_columns.end(), column) -
                          problem.free_columns.begin();
    out->jacobian(row, position) = 1.0 / problem.priors[column];
    out->residuals[row] =
        (values[column] - nominal[column]) / problem.priors[column];
  }
}

// The least-squares step of minimum norm, W+ r, with the first `rank` singular
// values.
Eigen::VectorXd PseudoInverseStep(const Svd& svd,
                                  const Eigen::VectorXd& residuals,
                                  Eigen::Index rank) {
  const Eigen::VectorXd rotated = svd.u.leftCols(rank).transpose() * residuals;
  return svd.v.leftCols(rank) * rotated.cwiseQuotient(svd.values.head(rank));
}

}  // namespace

SolverSummary SolvePseudoInverse(const CalibrationProblem& problem,
                                 const SolverOptions& options,
                                 Eigen::VectorXd* values) {
  Progress progress(problem, options, "pseudo_inverse");
  Eigen::VectorXd current = *values;
  if (!problem.losses.empty()) {
    progress.Stop(SolverStatus::kUnusable,
                  "the pseudo-inverse is least squares and takes no robust "
                  "loss: use the solver ceres");
  } else if (problem.lower.size() > 0) {
    progress.Stop(SolverStatus::kUnusable,
                  "the pseudo-inverse knows no bounds: use the solver ceres");
  } else {
    progress.Start(current);
  }
  const bool automatic = options.pseudo_inverse_tolerance == 0.0;
  const double tolerance =
      automatic ? kLaterTolerance : options.pseudo_inverse_tolerance;
  progress.summary().pseudo_inverse_tolerance_used = tolerance;
  Linearization linearization;
  while (!progress.stopped()) {
    LinearizeWithPriors(problem, current, &linearization);
    const Svd svd = ComputeSvd(linearization.jacobian);
    if (!(svd.values[0] > 0.0)) {
      // Squares of derivatives beyond the range of doubles leave none either.
      progress.Stop(SolverStatus::kFailed,
                    linearization.jacobian.isZero(0.0)
                        ? "no measurement depends on a free parameter"
                        : "the iteration diverged: its derivatives are not "
                          "finite, or their squares");
      break;
    }
    Eigen::Index rank = CountedRank(svd.values, tolerance);
    if (progress.summary().first_step_rank < 0) {
      const Eigen::Index start_rank = problem.start_rank.rank;
      // With a prior on every parameter no direction is left null_space.
      const bool short_rank =
          problem.ColumnsWithPrior().size() < problem.free_columns.size();
      if (automatic && short_rank && start_rank > 0) {
        rank = std::min(rank, start_rank);
      }
      progress.summary().first_step_rank = static_cast<int>(rank);
    }
    const Eigen::VectorXd step =
        PseudoInverseStep(svd, linearization.residuals, rank);
    for (Eigen::Index k = 0; k < step.size(); ++k) {
      current[problem.free_columns[k]] -= step[k];
    }
    progress.Record(
        {step.norm(), true, (linearization.jacobian * step).squaredNorm()},
        current);
  }
  progress.Finish();
  if (progress.summary().IsSolutionUsable()) *values = current;
  return progress.summary();
}

}  // namespace alidade::internal
