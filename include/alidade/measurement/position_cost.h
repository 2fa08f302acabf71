#ifndef ALIDADE_MEASUREMENT_POSITION_COST_H_
#define ALIDADE_MEASUREMENT_POSITION_COST_H_

#include <Eigen/Core>
#include <memory>

#include "alidade/model/arm.h"

namespace ceres {
class CostFunction;
}  // namespace ceres

namespace alidade {

/// One measured position at known joint values.
struct PositionObservation {
  const double* joint_values = nullptr;  ///< n values; must outlive the cost
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< measured (m)
  Eigen::Vector3d sigma = Eigen::Vector3d::Ones();     ///< (m), positive
};

/// The autodiff residual of one measured pose, whitened:
///
///   r = (p_predicted - p_measured) / sigma              (3)
///
/// over the parameter blocks beta, alpha, d, theta, r (n values each), and,
/// `with_frames`, base and tool (six each), in the order of
/// ParameterLayout::blocks(). `arm` gives joint types and, without frames, base
/// and tool; it must outlive the cost function.
///
/// Arms of up to seven joints without frames are ceres::AutoDiffCostFunctions,
/// all derivatives in one pass; others are ceres::DynamicAutoDiffCostFunctions
/// with the same residual.
std::unique_ptr<ceres::CostFunction> MakePositionCost(
    const Arm& arm, const PositionObservation& observation, bool with_frames);

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_POSITION_COST_H_
