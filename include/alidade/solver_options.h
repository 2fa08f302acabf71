#ifndef ALIDADE_SOLVER_OPTIONS_H_
#define ALIDADE_SOLVER_OPTIONS_H_

#include <functional>
#include <string>

#include "alidade/solver_summary.h"

namespace alidade {

/// How Levenberg-Marquardt gets residuals and Jacobians. Both have the same
/// cost, gradient and Gauss-Newton matrix.
enum class Evaluation {
  /// The faster one: the compressed one, which is so from the first pose on
  /// (docs/benchmarks.md).
  kAutomatic,
  kAutodiff,    ///< one autodiff residual per observation: the reference
  kCompressed,  ///< the triangular factor of all observations (compression.h)
};

/// Options of every solver; each states which solvers read it. Lengths in m.
struct SolverOptions {
  /// Most iterations, accepted and rejected together. All solvers. >= 1.
  int max_iterations = 50;

  /// Converged when the predicted relative decrease of the cost by a step,
  /// accepted or not, falls below this. All solvers. The default asks for all
  /// that double precision can tell in a cost with noise; exact data stop at
  /// the rounding floor instead. >= 0; 0 = never.
  double function_tolerance = 1e-15;

  /// Stop where rounding begins: when the change of the residuals that a step
  /// predicts is in the root mean square below this many times the rounding
  /// error of the model (eps * reach). All solvers. Past that point steps are
  /// noise. >= 0; 0 = never stop there.
  double rounding_floor_factor = 4.0;

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

#endif  // ALIDADE_SOLVER_OPTIONS_H_
