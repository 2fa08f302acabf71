#ifndef ALIDADE_SRC_SOLVE_BOUNDED_SOLVER_H_
#define ALIDADE_SRC_SOLVE_BOUNDED_SOLVER_H_

#include <Eigen/Core>
#include <functional>

#include "src/solve/solve.h"

namespace alidade::internal {

/// Solves a problem without bounds.
using UnboundedSolver = std::function<SolverSummary(
    const CalibrationProblem&, const SolverOptions&, Eigen::VectorXd*)>;

/// The minimum within problem.lower and .upper, by a primal active set (Nocedal
/// and Wright 2006, "Numerical Optimization", 16.5): solve for the parameters
/// that no bound holds, go towards the solution as far as the first bound that
/// is met, which holds from then on, and at a solution release the bound that
/// the cost presses against least, until the gradient presses against all.
/// Ceres' own bounds project steps onto the box, which is no descent where
/// parameters are correlated: it then stops far from the minimum.
/// Costs one solve for each bound that is met or left. `values` are within the
/// bounds. The iterations of all solves are in the summary.
SolverSummary SolveWithinBounds(const CalibrationProblem& problem,
                                const SolverOptions& options,
                                const UnboundedSolver& solve,
                                Eigen::VectorXd* values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_BOUNDED_SOLVER_H_
