#ifndef ALIDADE_SOLVER_H_
#define ALIDADE_SOLVER_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace alidade {

enum class SolverStatus {
  kNotRun,          ///< sentinel: nothing has happened yet
  kConverged,       ///< a tolerance of the options was met
  kPrecisionLimit,  ///< further steps are below the model's rounding error
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
  /// Norm of the step in the parameters (mixed m and rad); 0 at entry 0, and
  /// with Ceres 2.2 at steps rejected before the first that is accepted.
  double step_norm = 0.0;
  bool accepted = true;         ///< false: the step was rejected
  double time_s = 0.0;          ///< wall time since the solve began
  Eigen::VectorXd values = {};  ///< all parameters there; in no file
};

/// What a solver did. The same for every solver.
struct SolverSummary {
  std::string solver;  ///< "ceres" or "pseudo_inverse"
  SolverStatus status = SolverStatus::kNotRun;
  std::string message;  ///< one sentence: why it stopped, and what to try

  /// How residuals were evaluated: "autodiff", "reduced" or, of other
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
  /// Observations that the errors of the iterations leave out, because a
  /// calibration has rejected them as outliers in the end.
  std::int64_t num_rejected = 0;

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
  double precision_limit = 0.0;

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

/// How Levenberg-Marquardt gets residuals and Jacobians. Both have the same
/// cost, gradient and Gauss-Newton matrix.
enum class Evaluation {
  /// The faster one: the reduced one, which is so from the first pose on
  /// (docs/benchmarks.md).
  kAutomatic,
  kAutodiff,  ///< one autodiff residual per observation: the reference
  kReduced,   ///< the triangular factor of all observations
};

/// Options of every solver; each states which solvers read it. Lengths in m.
struct SolverOptions {
  /// Most iterations, accepted and rejected together. All solvers. >= 1.
  int max_iterations = 50;

  /// Converged when the predicted relative decrease of the cost by a step,
  /// accepted or not, falls below this. All solvers. The default asks for all
  /// that double precision can resolve in a cost with noise; exact data stop at
  /// the numerical precision limit instead. >= 0; 0 = never.
  double function_tolerance = 1e-15;

  /// Stop where rounding begins: when the change of the residuals that a step
  /// predicts is in the root mean square below this many times the rounding
  /// error of the model (eps * reach). All solvers. Past that point steps are
  /// noise. >= 0; 0 = never stop there.
  double precision_limit_factor = 4.0;

  /// Converged when the largest position error falls below this (m). All
  /// solvers. The study's "wanted precision". >= 0; 0 = not asked for.
  double wanted_precision = 0.0;

  /// Initial radius of the trust region. Levenberg-Marquardt. 0 = chosen from
  /// the identifiability pass, (30 / smallest singular value that counts)^2 and
  /// at least 1e4: the first steps are those of Gauss-Newton. Ceres' own 1e4
  /// creeps where the rank is short. > 0, or 0.
  double initial_trust_region_radius = 0.0;

  /// Singular values below this times the largest one count as zero in the
  /// pseudo-inverse. Baseline. 0 = chosen by the identifiability pass: the
  /// first step counts as many as the rank at the start, later ones all above
  /// 1e-12. [0, 1).
  double pseudo_inverse_tolerance = 0.0;

  /// Levenberg-Marquardt.
  Evaluation evaluation = Evaluation::kAutomatic;

  /// Threads for our own kernels. Ceres has one thread always, since its
  /// threads change bits. >= 1.
  int num_threads = 1;

  /// Called with every iteration, the start first, while the solve runs: for
  /// those who wait. All solvers. May be empty; must not throw.
  std::function<void(const IterationRecord&)> on_iteration = {};

  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

}  // namespace alidade

#endif  // ALIDADE_SOLVER_H_
