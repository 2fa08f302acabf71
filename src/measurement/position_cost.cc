#include "alidade/measurement/position_cost.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include "alidade/model/forward_kinematics.h"
#include "alidade/model/parameter_layout.h"

namespace alidade {
namespace {

class PositionResidual {
 public:
  PositionResidual(const Arm& arm, const PositionObservation& observation)
      : arm_(&arm),
        joint_values_(observation.joint_values),
        position_(observation.position),
        inverse_sigma_(observation.sigma.cwiseInverse()) {}

  // For AutoDiffCostFunction: the joint blocks only.
  template <typename T>
  bool operator()(const T* beta, const T* alpha, const T* d, const T* theta,
                  const T* r, T* residual) const {
    return Evaluate(GeometryView<T>{beta, alpha, d, theta, r}, residual);
  }

  // For DynamicAutoDiffCostFunction: five blocks, or seven with the frames.
  template <typename T>
  bool operator()(const T* const* blocks, T* residual) const {
    GeometryView<T> geometry{blocks[0], blocks[1], blocks[2], blocks[3],
                             blocks[4]};
    if (with_frames) {
      geometry.base = blocks[5];
      geometry.tool = blocks[6];
    }
    return Evaluate(geometry, residual);
  }

  bool with_frames = false;

 private:
  template <typename T>
  bool Evaluate(const GeometryView<T>& geometry, T* residual) const {
    const Vector3<T> predicted = TargetPosition(*arm_, geometry, joint_values_);
    for (int axis = 0; axis < 3; ++axis) {
      residual[axis] =
          (predicted[axis] - position_[axis]) * inverse_sigma_[axis];
    }
    return true;
  }

  const Arm* arm_;
  const double* joint_values_;
  Eigen::Vector3d position_;
  Eigen::Vector3d inverse_sigma_;
};

template <int n>
std::unique_ptr<ceres::CostFunction> MakeStatic(const PositionResidual& cost) {
  return std::make_unique<
      ceres::AutoDiffCostFunction<PositionResidual, 3, n, n, n, n, n>>(
      new PositionResidual(cost));
}

std::unique_ptr<ceres::CostFunction> MakeDynamic(const PositionResidual& cost,
                                                 const Arm& arm) {
  auto dynamic =
      std::make_unique<ceres::DynamicAutoDiffCostFunction<PositionResidual>>(
          new PositionResidual(cost));
  const ParameterLayout layout(arm.num_joints());
  for (const ParameterBlock& block : layout.blocks()) {
    const ParameterKind kind = layout.parameter(block.first_column).kind;
    if (cost.with_frames || ParameterLayout::IsJointKind(kind)) {
      dynamic->AddParameterBlock(block.size);
    }
  }
  dynamic->SetNumResiduals(3);
  return dynamic;
}

}  // namespace

std::unique_ptr<ceres::CostFunction> MakePositionCost(
    const Arm& arm, const PositionObservation& observation, bool with_frames) {
  PositionResidual cost(arm, observation);
  cost.with_frames = with_frames;
  if (with_frames) return MakeDynamic(cost, arm);
  switch (arm.num_joints()) {
    case 1:
      return MakeStatic<1>(cost);
    case 2:
      return MakeStatic<2>(cost);
    case 3:
      return MakeStatic<3>(cost);
    case 4:
      return MakeStatic<4>(cost);
    case 5:
      return MakeStatic<5>(cost);
    case 6:
      return MakeStatic<6>(cost);
    case 7:
      return MakeStatic<7>(cost);
    default:
      return MakeDynamic(cost, arm);
  }
}

}  // namespace alidade
