#ifndef ALIDADE_SRC_SOLVE_FORMULATION_H_
#define ALIDADE_SRC_SOLVE_FORMULATION_H_

#include <ceres/problem.h>
#include <ceres/types.h>

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "src/kernel/reduction.h"
#include "src/solve/progress.h"
#include "src/solve/solve.h"

namespace alidade::internal {

/// A column of the Jacobian whose norm is below this part of the largest is
/// rounding: its parameter moves nothing here.
constexpr double kRoundingColumn = 1e-12;

/// A calibration problem as Ceres is given it. The cost that Ceres sees, its
/// gradient and its Gauss-Newton matrix are the same in every formulation.
class Formulation {
 public:
  virtual ~Formulation() = default;
  virtual ceres::Problem* problem() = 0;
  /// All values of the layout at Ceres' current point.
  virtual Eigen::VectorXd Values() const = 0;
  /// How steps are solved for from the starting point on.
  virtual ceres::LinearSolverType linear_solver() const {
    return ceres::DENSE_QR;
  }
  /// Where no derivatives were made at the step that was tried last, as it ends
  /// the solve: what the linear model expects chi-square to lose by it, by
  /// which that was decided.
  virtual std::optional<double> PredictedDecrease() const {
    return std::nullopt;
  }
};

/// One autodiff residual per observation over the blocks of the layout
/// (observation_cost.h). Blocks without a free column are held constant, blocks
/// with some by a SubsetManifold.
std::unique_ptr<Formulation> MakeAutodiffFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values);

/// One residual for all observations and priors, from the triangular factor of
/// [J r] (reduction.h), over one block of the free parameters. `start`: the
/// reduced problem at `values`, by the reducer of `progress`, which outlives
/// the formulation and decides which step is the last.
std::unique_ptr<Formulation> MakeReducedFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values,
    ReducedLeastSquares start, Progress* progress);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_FORMULATION_H_
