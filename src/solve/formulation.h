#ifndef ALIDADE_SRC_SOLVE_FORMULATION_H_
#define ALIDADE_SRC_SOLVE_FORMULATION_H_

#include <ceres/problem.h>

#include <Eigen/Core>
#include <memory>

#include "src/kernel/compression.h"
#include "src/solve/solver.h"

namespace alidade::internal {

/// A calibration problem as Ceres is given it. The cost that Ceres sees, its
/// gradient and its Gauss-Newton matrix are the same in every formulation.
class Formulation {
 public:
  virtual ~Formulation() = default;
  virtual ceres::Problem* problem() = 0;
  /// All values of the layout at Ceres' current point.
  virtual Eigen::VectorXd Values() const = 0;
};

/// One autodiff residual per observation over the blocks of the layout
/// (observation_cost.h). Blocks without a free column are held constant, blocks
/// with some by a SubsetManifold.
std::unique_ptr<Formulation> MakeAutodiffFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values);

/// One residual for all observations, the triangular factor of [J r]
/// (compression.h), over one block of the free parameters. `compressor` is of
/// the problem's free columns and losses, and outlives the formulation.
std::unique_ptr<Formulation> MakeCompressedFormulation(
    const CalibrationProblem& problem, const Eigen::VectorXd& values,
    Compressor* compressor);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_FORMULATION_H_
