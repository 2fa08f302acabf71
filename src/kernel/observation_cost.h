#ifndef ALIDADE_SRC_KERNEL_OBSERVATION_COST_H_
#define ALIDADE_SRC_KERNEL_OBSERVATION_COST_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "alidade/dataset.h"
#include "src/kernel/measurement_model.h"

namespace ceres {
class CostFunction;
}  // namespace ceres

namespace alidade::internal {

/// An autodiff residual, and the parameter blocks that it is a function of, as
/// indices of ParameterLayout::blocks().
struct ObservationCost {
  std::unique_ptr<ceres::CostFunction> function;
  std::vector<int> blocks;
};

/// The whitened residual (dataset.h) of observation i of a block, as autodiff
/// takes it: over the blocks beta, alpha, d, theta, r (n values each), and,
/// `with_frames` or where the kind has references, base and the target's tool
/// (six each), then the references (three each). Without frames, base and tool
/// are the nominal arm's. Model and data outlive the cost function.
///
/// Positions of arms of up to seven joints without frames are
/// ceres::AutoDiffCostFunctions, all derivatives in one pass; others are
/// ceres::DynamicAutoDiffCostFunctions with the same residual.
ObservationCost MakeObservationCost(const MeasurementModel& model,
                                    const Dataset& data,
                                    const ObservationBlock& block,
                                    Eigen::Index i, bool with_frames);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_OBSERVATION_COST_H_
