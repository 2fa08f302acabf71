#ifndef ALIDADE_SRC_SOLVE_SOLVE_H_
#define ALIDADE_SRC_SOLVE_SOLVE_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/identifiability.h"
#include "alidade/robust_loss.h"
#include "alidade/solver.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What is to be solved: minimise chi-square over the free columns,
///
///   min  sum_i |(predicted_i(values) - measured_i) / sigma_i|^2,
///
/// all other values staying as they are in the starting point.
///
/// \code
///   MeasurementModel model(arm);
///   const IdentifiabilityResult pass =
///       AnalyzeIdentifiability(model, data, {});
///   CalibrationProblem problem{model, data, FreeColumns(pass),
///                              pass.nominal_rank, PriorsOf(pass)};
///   Eigen::VectorXd values = model.NominalValues();
///   SolverSummary summary =
///       SolveLevenbergMarquardt(problem, SolverOptions(), &values);
///   if (summary.IsSolutionUsable())
///     arm = model.layout().WithValues(arm, values);
/// \endcode
///
/// The references must outlive the solve.
struct CalibrationProblem {
  const MeasurementModel& model;
  const Dataset& data;
  std::vector<int> free_columns;  ///< ascending, no repeats
  /// Rank of the free columns at the starting point, from the identifiability
  /// pass; it decides the automatic tolerances. Left empty, the rank is taken
  /// as full.
  RankReport start_rank = {};
  /// Gaussian priors: the standard deviation of each parameter about its
  /// nominal value, one entry per column; NaN or infinite where there is none,
  /// empty for none at all. With priors the solution is a maximum a posteriori
  /// estimate, and cost is chi-square plus sum ((value - nominal) / prior)^2.
  Eigen::VectorXd priors = {};
  /// How the cost grows with the whitened residual of an observation:
  /// chi-square becomes sum_i rho(|r_i|^2), rho that of the observation's
  /// dimension (entry 0 of one row, and so on, as TunedLosses gives them);
  /// empty: least squares. Levenberg-Marquardt only; the baseline refuses it.
  std::vector<RobustLoss> losses = {};
  /// Limits of the values, one entry per column of the layout (infinite where
  /// there is none), or empty. Levenberg-Marquardt only; the baseline refuses
  /// them. The starting point is within them.
  Eigen::VectorXd lower = {};
  Eigen::VectorXd upper = {};

  /// Free columns that have a prior, in ascending order.
  std::vector<int> ColumnsWithPrior() const;
};

/// Levenberg-Marquardt by Ceres, as the options say over one autodiff residual
/// per observation (observation_cost.h), the reference, or over the reduced
/// problem of all of them (reduction.h). One Ceres thread, so that the same
/// problem gives the same bits.
///
/// The solvers share this signature. `values` holds the starting point and
/// receives the solution; it is unchanged where the summary is not usable.
/// Nothing is thrown for numerical trouble or invalid options: the status is
/// kUnusable or kFailed and the message says what to do.
SolverSummary SolveLevenbergMarquardt(const CalibrationProblem& problem,
                                      const SolverOptions& options,
                                      Eigen::VectorXd* values);

/// SolveLevenbergMarquardt with a robust loss, from a start that is good enough
/// for it: least squares first (or Huber, for the losses after it), then
/// Cauchy, then Tukey, as far as `loss` asks, each with the tuning constant of
/// 95 % efficiency and from the solution of the one before. A redescending loss
/// alone would stop at whatever local minimum is next to the start.
///
/// With a `start` near the solution, one that has its outliers far off, the
/// last of these begins there, at once.
///
/// `problem.losses` are not used. The summary is that of the last solve, its
/// iterations those of all of them; a stage that is not usable ends it. A
/// solution that gives nearly all observations up is kFailed.
SolverSummary SolveRobust(const CalibrationProblem& problem, LossKind loss,
                          const SolverOptions& options, Eigen::VectorXd* values,
                          const Eigen::VectorXd& start = {});

/// The baseline, the study's own algorithm: the whitened Jacobian W of all
/// poses, its Moore-Penrose inverse W+ by singular value decomposition, and
///
///   values <- values - W+ residuals
///
/// for all free parameters at once, until the wanted precision or for a fixed
/// number of iterations. No step control: it may diverge (kFailed). Singular
/// values below the tolerance of the options count as zero; where the rank at
/// the start is short, the tolerance decides whether it converges at all.
/// Cost per iteration: O(N p^2).
SolverSummary SolvePseudoInverse(const CalibrationProblem& problem,
                                 const SolverOptions& options,
                                 Eigen::VectorXd* values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_SOLVE_H_
