#include "alidade/measurement/geometric_jacobian.h"

#include "alidade/model/rotation.h"

namespace alidade {

int RowsOf(MeasurementKind kind) {
  return kind == MeasurementKind::kPosition ? 3 : 6;
}

GeometricJacobian::GeometricJacobian(const Arm& nominal,
                                     const ParameterLayout& layout,
                                     const Eigen::VectorXd& values)
    : layout_(layout),
      arm_(layout.WithValues(nominal, values)),
      base_origin_(arm_.instrument_from_base.translation()),
      base_axes_(LeftJacobianOfRotation(
          values.segment<3>(layout.Column(ParameterKind::kBaseRotation, 0)))),
      tool_axes_(LeftJacobianOfRotation(
          values.segment<3>(layout.Column(ParameterKind::kToolRotation, 0)))) {}

void GeometricJacobian::Evaluate(const double* joint_values,
                                 const std::vector<int>& columns,
                                 MeasurementKind kind,
                                 Eigen::Ref<Eigen::MatrixXd> out) {
  ComputeChainAxes(arm_, joint_values, &axes_);
  for (Eigen::Index c = 0; c < out.cols(); ++c) {
    out.col(c).head<3>() = PositionDerivative(columns[c]);
    if (kind == MeasurementKind::kPose) {
      out.col(c).segment<3>(3) = RotationDerivative(columns[c]);
    }
  }
}

Eigen::Vector3d GeometricJacobian::PositionDerivative(int column) const {
  const Parameter& parameter = layout_.parameter(column);
  const int k = parameter.index;
  const Eigen::Vector3d target = axes_.instrument_from_target.translation();
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
      return axes_.instrument_from_last.linear().col(k);
    case ParameterKind::kToolRotation:
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
      return axes_.instrument_from_last.linear() * tool_axes_.col(k);
    case ParameterKind::kD:
    case ParameterKind::kR:
    case ParameterKind::kBaseTranslation:
    case ParameterKind::kToolTranslation:
      break;
  }
  // A translation turns nothing.
  return Eigen::Vector3d::Zero();
}

}  // namespace alidade
