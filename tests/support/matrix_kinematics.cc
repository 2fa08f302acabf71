#include "tests/support/matrix_kinematics.h"

namespace alidade::internal::testing {

Matrix3l MatrixFromVector(const Vector3l& w) {
  const long double angle = w.norm();
  if (angle == 0.0L) return Matrix3l::Identity();
  const long double c = std::cos(0.5L * angle);
  const Vector3l v = w * (std::sin(0.5L * angle) / angle);
  Matrix3l m;
  m << 1 - 2 * (v.y() * v.y() + v.z() * v.z()), 2 * (v.x() * v.y() - c * v.z()),
      2 * (v.x() * v.z() + c * v.y()), 2 * (v.x() * v.y() + c * v.z()),
      1 - 2 * (v.x() * v.x() + v.z() * v.z()), 2 * (v.y() * v.z() - c * v.x()),
      2 * (v.x() * v.z() - c * v.y()), 2 * (v.y() * v.z() + c * v.x()),
      1 - 2 * (v.x() * v.x() + v.y() * v.y());
  return m;
}

VectorXl MatrixValues(const Arm& arm) {
  const ParameterLayout layout(arm);
  VectorXl values = VectorXl::Zero(layout.size());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    values[layout.Column(ParameterKind::kBeta, j)] = joint.beta;
    values[layout.Column(ParameterKind::kAlpha, j)] = joint.alpha;
    values[layout.Column(ParameterKind::kD, j)] = joint.d;
    values[layout.Column(ParameterKind::kTheta, j)] = joint.theta;
    values[layout.Column(ParameterKind::kR, j)] = joint.r;
  }
  for (int axis = 0; axis < 3; ++axis) {
    values[layout.Column(ParameterKind::kBaseTranslation, axis)] =
        arm.instrument_from_base.translation()[axis];
    for (int target = 0; target < arm.num_targets(); ++target) {
      values[layout.Column(ParameterKind::kToolTranslation, axis, target)] =
          arm.last_from_target(target).translation()[axis];
    }
  }
  return values;
}

Matrix4l JointMatrix(const Arm& nominal, const ParameterLayout& layout,
                     const VectorXl& values, int j, double q,
                     const MatrixJointError& error) {
  const auto value = [&](ParameterKind kind) {
    return values[layout.Column(kind, j)];
  };
  const bool revolute = nominal.joints[j].type == JointType::kRevolute;
  const long double shifted = error.shift + q;
  const long double turn = revolute ? shifted : 0.0L;
  const long double travel = revolute ? 0.0L : shifted;
  return RotationY(value(ParameterKind::kBeta)) *
         RotationX(value(ParameterKind::kAlpha)) *
         Translation({value(ParameterKind::kD), 0.0L, 0.0L}) *
         RotationZ(value(ParameterKind::kTheta) + turn) * TiltMatrix(error) *
         Translation({0.0L, 0.0L, value(ParameterKind::kR) + travel});
}

Matrix4l FrameMatrix(const Eigen::Isometry3d& nominal, const VectorXl& values,
                     int translation_column, int rotation_column) {
  Matrix4l frame = Matrix4l::Identity();
  frame.topLeftCorner<3, 3>() =
      MatrixFromVector(values.segment<3>(rotation_column)) *
      nominal.linear().cast<long double>();
  frame.topRightCorner<3, 1>() = values.segment<3>(translation_column);
  return frame;
}

Matrix4l MatrixTargetFrame(const Arm& nominal, const ParameterLayout& layout,
                           const VectorXl& values, const double* joint_values,
                           int target, const double* covariates) {
  Matrix4l frame =
      FrameMatrix(nominal.instrument_from_base, values,
                  layout.Column(ParameterKind::kBaseTranslation, 0),
                  layout.Column(ParameterKind::kBaseRotation, 0)) *
      MotionBy(nominal, covariates, true);
  const std::vector<MatrixJointError> errors =
      MatrixErrors(nominal, joint_values, covariates);
  for (int j = 0; j < nominal.num_joints(); ++j) {
    frame = frame *
            JointMatrix(nominal, layout, values, j, joint_values[j], errors[j]);
  }
  return frame * MotionBy(nominal, covariates, false) *
         FrameMatrix(nominal.last_from_target(target), values,
                     layout.Column(ParameterKind::kToolTranslation, 0, target),
                     layout.Column(ParameterKind::kToolRotation, 0, target));
}

Matrix4l MatrixTargetFrame(const Arm& nominal, const VectorXl& values,
                           const double* joint_values, int target) {
  return MatrixTargetFrame(nominal, ParameterLayout(nominal), values,
                           joint_values, target);
}

Matrix4l MatrixTargetFrame(const Arm& arm, const double* joint_values) {
  return MatrixTargetFrame(arm, MatrixValues(arm), joint_values);
}

Vector3l MatrixPosition(const Arm& nominal, const VectorXl& values,
                        const double* joint_values, int target) {
  return MatrixTargetFrame(nominal, values, joint_values, target)
      .topRightCorner<3, 1>();
}

Vector3l MatrixPosition(const Arm& arm, const double* joint_values) {
  return MatrixPosition(arm, MatrixValues(arm), joint_values);
}

Matrix3Xl MatrixJacobian(const Arm& nominal, const VectorXl& values,
                         const double* joint_values) {
  Matrix3Xl jacobian(3, values.size());
  for (Eigen::Index column = 0; column < values.size(); ++column) {
    const auto difference = [&](long double step) -> Vector3l {
      VectorXl above = values;
      VectorXl below = values;
      above[column] += step;
      below[column] -= step;
      return (MatrixPosition(nominal, above, joint_values) -
              MatrixPosition(nominal, below, joint_values)) /
             (above[column] - below[column]);
    };
    const long double h = 0x1p-9L;
    const Vector3l coarse = difference(h);
    const Vector3l middle = difference(h / 2);
    const Vector3l fine = difference(h / 4);
    const Vector3l first = (4 * middle - coarse) / 3;
    const Vector3l second = (4 * fine - middle) / 3;
    jacobian.col(column) = (16 * second - first) / 15;
  }
  return jacobian;
}

}  // namespace alidade::internal::testing
