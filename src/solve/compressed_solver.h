#ifndef ALIDADE_SRC_SOLVE_COMPRESSED_SOLVER_H_
#define ALIDADE_SRC_SOLVE_COMPRESSED_SOLVER_H_

#include <Eigen/Core>

#include "src/kernel/compression.h"
#include "src/solve/progress.h"
#include "src/solve/solver.h"

namespace alidade::internal {

/// Levenberg-Marquardt over the compressed problem, whose few rows stand for
/// all observations: a step solves
///
///   min |R x + z|^2 + |P x + w|^2 + |D x|^2,   D^2 = diag(J^T J) / radius,
///
/// and the radius follows the gain ratio as in Ceres (Madsen, Nielsen and
/// Tingleff 2004, "Methods for non-linear least squares problems", section 3.2;
/// a step is taken where it gains a thousandth of what was predicted). Ceres
/// itself would take longer for its own books than such a problem takes
/// (docs/benchmarks.md); it is the reference, over the observations one by one.
///
/// A trial's cost and its Jacobian are made in one pass, as most trials are
/// taken; of a trial that is to be the last the cost alone is.
///
/// `compressed` is the problem at `values`, which receive the solution. The
/// problem has no bounds. Until `progress` says stop.
void IterateLevenbergMarquardt(const CalibrationProblem& problem, double radius,
                               CompressedProblem* compressed,
                               Progress* progress, Eigen::VectorXd* values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_COMPRESSED_SOLVER_H_
