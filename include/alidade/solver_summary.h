#ifndef ALIDADE_SOLVER_SUMMARY_H_
#define ALIDADE_SOLVER_SUMMARY_H_

#include <string>
#include <vector>

namespace alidade {

enum class SolverStatus {
  kNotRun,          ///< sentinel: nothing has happened yet
  kConverged,       ///< a tolerance of the options was met
  kRoundingFloor,   ///< further steps are below the model's rounding error
  kIterationLimit,  ///< stopped by the number of iterations; may be usable
  kFailed,          ///< the iteration diverged or could not take a step
  kUnusable,        ///< the problem cannot be solved: see the message
};

/// "converged", "stopped at the numerical precision limit" ...
const char* ToString(SolverStatus status);

/// State after one iteration; entry 0 is the initial point.
struct IterationRecord {
  int iteration = 0;
  double cost = 0.0;       ///< chi-square, sum of squared whitened residuals
  double max_error = 0.0;  ///< largest |p_predicted - p_measured| (m)
  double rms_error = 0.0;  ///< root mean square of the same (m)
  /// Norm of the step in the parameters (mixed m and rad); 0 at entry 0.
  double step_norm = 0.0;
  bool accepted = true;  ///< false: the step was tried and taken back
  double time_s = 0.0;   ///< wall time since the solve began
};

/// What a solver did. The same for every solver.
struct SolverSummary {
  std::string solver;  ///< "ceres" or "pseudo_inverse"
  SolverStatus status = SolverStatus::kNotRun;
  std::string message;  ///< one sentence: why it stopped, and what to try

  /// How residuals were evaluated: "autodiff", "compressed" or, of other
  /// solvers, nothing.
  std::string evaluation;

  int num_poses = 0;
  int num_residuals = 0;
  int num_parameters = 0;  ///< of the model, all blocks
  int num_free = 0;        ///< solved for

  /// Cost is chi-square: twice what Ceres prints. -1 = never evaluated.
  double initial_cost = -1.0;
  double final_cost = -1.0;
  int accepted_steps = 0;
  int rejected_steps = 0;
  std::vector<IterationRecord> iterations;

  int threads_given = 0;
  int threads_used = 0;
  /// As given in the options (0 = chosen for the user) and as used.
  double trust_region_given = 0.0;
  double trust_region_used = 0.0;
  double pseudo_inverse_tolerance_given = 0.0;
  double pseudo_inverse_tolerance_used = 0.0;
  /// Singular values that the pseudo-inverse counted at the first step;
  /// -1 for other solvers.
  int first_step_rank = -1;
  /// The floor that was used: largest rounding error of a coordinate (m).
  double rounding_floor = 0.0;

  double setup_time_s = 0.0;
  double solve_time_s = 0.0;

  /// True where the values may be used: converged, at the floor, or stopped by
  /// a number of iterations that the user asked for, with a cost that did not
  /// grow.
  bool IsSolutionUsable() const;
  /// One line.
  std::string BriefReport() const;
  /// Everything above but the table of iterations, a line each.
  std::string FullReport() const;
};

}  // namespace alidade

#endif  // ALIDADE_SOLVER_SUMMARY_H_
