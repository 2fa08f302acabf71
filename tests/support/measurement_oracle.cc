#include "tests/support/measurement_oracle.h"

namespace alidade::internal::testing {

Vector3l LogOfMatrix(const Matrix3l& matrix, const Vector3l& near) {
  constexpr long double kTurn = 6.283185307179586476925286766559005768L;
  // Frames of arms are rotations to 1e-16 only, and the two parts would differ
  // by so much: a step of Newton's makes it 1e-32.
  const Matrix3l r = matrix * (1.5L * Matrix3l::Identity() -
                               0.5L * matrix.transpose() * matrix);
  const Vector3l odd(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  const long double sine = 0.5L * odd.norm();
  const long double cosine = 0.5L * (r.trace() - 1.0L);
  const long double angle = std::atan2(sine, cosine);
  Vector3l axis = Vector3l::Zero();
  if (cosine < -0.5L) {
    const Matrix3l even = 0.5L * (r + r.transpose());
    Eigen::Index largest = 0;
    even.diagonal().maxCoeff(&largest);
    axis = even.col(largest) - cosine * Vector3l::Unit(largest);
    axis.normalize();
    if (axis.dot(odd) < 0.0L) axis = -axis;
  } else if (sine > 0.0L) {
    axis = odd / odd.norm();
  }
  const Vector3l shortest = angle * axis;
  const Vector3l other = (angle - kTurn) * axis;
  const bool is_nearer = (other - near).norm() < (shortest - near).norm();
  return is_nearer ? other : shortest;
}

void TangentsOf(const Vector3l& n, Vector3l* t1, Vector3l* t2) {
  const long double sign = std::signbit(n.z()) ? -1.0L : 1.0L;
  const Vector3l z = sign * n;
  const Vector3l axis = Vector3l::UnitZ().cross(z);
  const long double sine = axis.norm();
  Vector3l turn = Vector3l::Zero();
  if (sine > 0.0L) turn = std::atan2(sine, z.z()) / sine * axis;
  const Matrix3l frame = MatrixFromVector(turn);
  *t1 = frame.col(0);
  *t2 = sign * frame.col(1);
}

Vector3l OracleNormal(const MeasuredArm& measured, const VectorXl& values,
                      int plane) {
  const Vector3l nominal =
      measured.references.planes[plane].normal.cast<long double>();
  Vector3l t1;
  Vector3l t2;
  TangentsOf(nominal, &t1, &t2);
  const int tilt = measured.layout.Column(ParameterKind::kPlaneTilt, 0, plane);
  return (nominal + values[tilt] * t1 + values[tilt + 1] * t2).normalized();
}

Vector3l OraclePoint(const MeasuredArm& measured, const VectorXl& values,
                     int point) {
  return values.segment<3>(
      measured.layout.Column(ParameterKind::kPoint, 0, point));
}

Matrix4l OracleFrame(const MeasuredArm& measured, const VectorXl& values,
                     int pose, int target) {
  std::vector<double> covariates;
  for (const CovariateEffect& effect : measured.arm.errors.covariates) {
    const std::vector<std::string>& names = measured.data.covariate_names;
    const auto row = std::find(names.begin(), names.end(), effect.name);
    covariates.push_back(row == names.end() ? effect.reference
                                            : measured.data.covariates(
                                                  row - names.begin(), pose));
  }
  return MatrixTargetFrame(measured.arm, measured.layout, values,
                           measured.data.joint_values.col(pose).data(), target,
                           covariates.data());
}

Vector3l OraclePosition(const MeasuredArm& measured, const VectorXl& values,
                        int pose, int target) {
  return OracleFrame(measured, values, pose, target).topRightCorner<3, 1>();
}

VectorXl OracleResidual(const MeasuredArm& measured, const VectorXl& values,
                        const ObservationBlock& block, Eigen::Index i,
                        const Vector3l& near) {
  const auto point = [&](int k) { return OraclePoint(measured, values, k); };
  const auto position = [&](int pose) {
    return OraclePosition(measured, values, pose, block.target(i));
  };
  VectorXl residual = -block.measured.col(i).cast<long double>();
  switch (block.kind) {
    case MeasurementKind::kPosition:
      residual += position(block.pose(i));
      break;
    case MeasurementKind::kPose: {
      const Matrix3l back = MatrixFromVector(residual.tail<3>());
      const Matrix4l frame =
          OracleFrame(measured, values, block.pose(i), block.target(i));
      residual.head<3>() += frame.topRightCorner<3, 1>();
      residual.tail<3>() =
          LogOfMatrix(frame.topLeftCorner<3, 3>() * back, near);
      break;
    }
    case MeasurementKind::kDistance:
      residual[0] +=
          (position(block.pose(i)) - point(block.references[i])).norm();
      break;
    case MeasurementKind::kFixedPoint:
      residual = position(block.pose(i)) - point(block.references[i]);
      break;
    case MeasurementKind::kPlane: {
      const int plane = block.references[i];
      residual[0] =
          OracleNormal(measured, values, plane).dot(position(block.pose(i))) -
          values[measured.layout.Column(ParameterKind::kPlaneOffset, 0, plane)];
      break;
    }
    case MeasurementKind::kDifference:
      residual += position(block.pose(i)) - position(block.seconds[i]);
      break;
    case MeasurementKind::kPointDistance:
      residual[0] +=
          (point(block.references[i]) - point(block.seconds[i])).norm();
      break;
  }
  return residual;
}

MatrixXl OracleWhitener(const ObservationBlock& block, Eigen::Index i) {
  if (!block.whiteners.empty() && block.whiteners[i].size() > 0) {
    return block.whiteners[i].cast<long double>();
  }
  MatrixXl whitener = MatrixXl::Zero(block.rows_each(), block.rows_each());
  for (int row = 0; row < block.rows_each(); ++row) {
    const double sigma = block.sigmas(row, i);
    whitener(row, row) = std::isinf(sigma) ? 0.0L : 1.0L / sigma;
  }
  return whitener;
}

MatrixXl OracleJacobian(const MeasuredArm& measured, const VectorXl& values,
                        const ObservationBlock& block, Eigen::Index i,
                        const Vector3l& near) {
  MatrixXl jacobian(block.rows_each(), values.size());
  for (Eigen::Index column = 0; column < values.size(); ++column) {
    const auto difference = [&](long double step) -> VectorXl {
      VectorXl above = values;
      VectorXl below = values;
      above[column] += step;
      below[column] -= step;
      return (OracleResidual(measured, above, block, i, near) -
              OracleResidual(measured, below, block, i, near)) /
             (above[column] - below[column]);
    };
    const long double h = 0x1p-9L;
    const VectorXl coarse = difference(h);
    const VectorXl middle = difference(h / 2);
    const VectorXl fine = difference(h / 4);
    const VectorXl first = (4 * middle - coarse) / 3;
    const VectorXl second = (4 * fine - middle) / 3;
    jacobian.col(column) = (16 * second - first) / 15;
  }
  return jacobian;
}

}  // namespace alidade::internal::testing
