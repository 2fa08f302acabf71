#ifndef ALIDADE_BENCH_ANALYTIC_CERES_H_
#define ALIDADE_BENCH_ANALYTIC_CERES_H_

#include <Eigen/Core>

#include "src/solve/solve.h"

namespace alidade::internal::bench {

/// What a good engineer writes without Alidade: Ceres over one residual block
/// for each pose, with derivatives in closed form from the axes of the chain,
/// normal equations, one thread, and the stopping rules of
/// SolveLevenbergMarquardt. Positions of an arm whose free parameters belong to
/// its joints. Returns chi-square.
double SolveAnalytic(const CalibrationProblem& problem,
                     const SolverOptions& options, Eigen::VectorXd* values,
                     int* iterations);

}  // namespace alidade::internal::bench

#endif  // ALIDADE_BENCH_ANALYTIC_CERES_H_
