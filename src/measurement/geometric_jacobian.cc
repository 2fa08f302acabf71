#include "alidade/measurement/geometric_jacobian.h"

#include "alidade/model/rotation.h"

namespace alidade {

GeometricJacobian::GeometricJacobian(const Arm& nominal,
                                     const ParameterLayout& layout,
                                     const Eigen::VectorXd& values)
    : layout_(layout),
      arm_(layout.WithValues(nominal, values)),
      base_origin_(arm_.instrument_from_base.translation()),
      base_axes_(LeftJacobianOfRotation(
          values.segment<3>(layout.Column(ParameterKind::kBaseRotation, 0)))) {
  for (int target = 0; target < arm_.num_targets(); ++target) {
    tool_axes_.push_back(LeftJacobianOfRotation(values.segment<3>(
        layout.Column(ParameterKind::kToolRotation, 0, target))));
  }
}

void GeometricJacobian::MoveTo(const double* joint_values, int target) {
  ComputeChainAxes(arm_, joint_values, &axes_);
  target_ = target;
  instrument_from_target_ =
      axes_.instrument_from_last * arm_.last_from_target(target);
}

Eigen::Vector3d GeometricJacobian::PositionDerivative(int column) const {
  const Parameter& parameter = layout_.parameter(column);
  const int k = parameter.index;
  const Eigen::Vector3d target = instrument_from_target_.translation();
  switch (parameter.kind) {
    case ParameterKind::kBeta:
      return axes_.beta_axis.col(k).cross(target - axes_.origin_before.col(k));
    case ParameterKind::kAlpha:
      return axes_.alpha_axis.col(k).cross(target - axes_.origin_before.col(k));
    case ParameterKind::kD:
      return axes_.alpha_axis.col(k);
    case ParameterKind::kTheta:
      return axes_.joint_axis.col(k).cross(target -
                                           axes_.origin_on_axis.col(k));
    case ParameterKind::kR:
      return axes_.joint_axis.col(k);
    case ParameterKind::kBaseTranslation:
      return Eigen::Vector3d::Unit(k);
    case ParameterKind::kBaseRotation:
      return base_axes_.col(k).cross(target - base_origin_);
    case ParameterKind::kToolTranslation:
      if (parameter.object != target_) break;
      return axes_.instrument_from_last.linear().col(k);
    case ParameterKind::kToolRotation:
    case ParameterKind::kPoint:
    case ParameterKind::kPlaneTilt:
    case ParameterKind::kPlaneOffset:
      break;
  }
  // A rotation of the target about its own origin moves no position.
  return Eigen::Vector3d::Zero();
}

Eigen::Vector3d GeometricJacobian::RotationDerivative(int column) const {
  const Parameter& parameter = layout_.parameter(column);
  const int k = parameter.index;
  switch (parameter.kind) {
    case ParameterKind::kBeta:
      return axes_.beta_axis.col(k);
    case ParameterKind::kAlpha:
      return axes_.alpha_axis.col(k);
    case ParameterKind::kTheta:
      return axes_.joint_axis.col(k);
    case ParameterKind::kBaseRotation:
      return base_axes_.col(k);
    case ParameterKind::kToolRotation:
      if (parameter.object != target_) break;
      return axes_.instrument_from_last.linear() * tool_axes_[target_].col(k);
    case ParameterKind::kD:
    case ParameterKind::kR:
    case ParameterKind::kBaseTranslation:
    case ParameterKind::kToolTranslation:
    case ParameterKind::kPoint:
    case ParameterKind::kPlaneTilt:
    case ParameterKind::kPlaneOffset:
      break;
  }
  // A translation turns nothing.
  return Eigen::Vector3d::Zero();
}

}  // namespace alidade
