#include "tests/support/reference_solution.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

namespace alidade::internal::testing {
namespace {

// One factor of T(j-1, j): a rotation about (`angular`) or a translation
// along one axis of the current frame.
struct ElementaryMotion {
  ParameterKind kind;
  bool angular;
  int axis;
};

constexpr std::array<ElementaryMotion, 5> kMotionsOfJoint = {{
    {ParameterKind::kBeta, true, 1},
    {ParameterKind::kAlpha, true, 0},
    {ParameterKind::kD, false, 0},
    {ParameterKind::kTheta, true, 2},
    {ParameterKind::kR, false, 2},
}};

Matrix4l MotionMatrix(const ElementaryMotion& motion, long double amount) {
  if (!motion.angular) {
    return Translation(amount * Vector3l::Unit(motion.axis));
  }
  if (motion.axis == 0) return RotationX(amount);
  return motion.axis == 1 ? RotationY(amount) : RotationZ(amount);
}

// G of a motion E: dE / d amount = E G.
Matrix4l MotionGenerator(const ElementaryMotion& motion) {
  Matrix4l generator = Matrix4l::Zero();
  if (motion.angular) {
    const int next = (motion.axis + 1) % 3;
    const int last = (motion.axis + 2) % 3;
    generator(last, next) = 1.0L;
    generator(next, last) = -1.0L;
  } else {
    generator(motion.axis, 3) = 1.0L;
  }
  return generator;
}

}  // namespace

ReferencePose EvaluateReference(const Arm& arm, const ParameterLayout& layout,
                                const VectorXl& values,
                                const double* joint_values) {
  Matrix4l frame = arm.instrument_from_base.matrix().cast<long double>();
  std::vector<Matrix4l> derivatives;
  std::vector<int> columns;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool revolute = arm.joints[j].type == JointType::kRevolute;
    const ParameterKind moved =
        revolute ? ParameterKind::kTheta : ParameterKind::kR;
    for (const ElementaryMotion& motion : kMotionsOfJoint) {
      const int column = layout.Column(motion.kind, j);
      const long double q = motion.kind == moved ? joint_values[j] : 0.0;
      const Matrix4l factor = MotionMatrix(motion, values[column] + q);
      for (Matrix4l& derivative : derivatives) derivative *= factor;
      frame *= factor;
      derivatives.push_back(frame * MotionGenerator(motion));
      columns.push_back(column);
    }
  }
  Vector4l target = Vector4l::Unit(3);
  target.head<3>() = arm.last_from_target().translation().cast<long double>();
  ReferencePose pose;
  pose.position = (frame * target).head<3>();
  pose.jacobian = Matrix3Xl::Zero(3, layout.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    pose.jacobian.col(columns[k]) = (derivatives[k] * target).head<3>();
  }
  return pose;
}

ReferenceLinearization LinearizeReference(const Arm& arm,
                                          const VectorXl& values,
                                          const Dataset& data,
                                          const std::vector<int>& columns) {
  const ParameterLayout layout(arm.num_joints());
  ReferenceLinearization out;
  out.residuals.resize(data.num_rows());
  out.jacobian.resize(data.num_rows(),
                      static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const ReferencePose pose =
        EvaluateReference(arm, layout, values, data.joint_values.col(i).data());
    const Vector3l sigma = data.sigmas().col(i).cast<long double>();
    const Vector3l error =
        pose.position - data.positions().col(i).cast<long double>();
    out.residuals.segment<3>(3 * i) = error.cwiseQuotient(sigma);
    for (Eigen::Index c = 0; c < out.jacobian.cols(); ++c) {
      out.jacobian.block<3, 1>(3 * i, c) =
          pose.jacobian.col(columns[c]).cwiseQuotient(sigma);
    }
  }
  return out;
}

MatrixXl ScaledDifferences(const Arm& arm, const VectorXl& values,
                           const Dataset& data,
                           const std::vector<int>& columns) {
  constexpr long double kStep = 1e-6L;
  const ParameterLayout layout(arm.num_joints());
  MatrixXl jacobian(data.num_rows(), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    VectorXl above = values;
    VectorXl below = values;
    above[columns[c]] += kStep;
    below[columns[c]] -= kStep;
    const bool angle =
        layout.parameter(columns[c]).dimension == Dimension::kAngle;
    const long double run = 2.0L * kStep * (angle ? ArmReach(arm) : 1.0);
    for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
      const double* q = data.joint_values.col(i).data();
      const Vector3l rise =
          MatrixPosition(arm, above, q) - MatrixPosition(arm, below, q);
      const Vector3l sigma = data.sigmas().col(i).cast<long double>();
      jacobian.block<3, 1>(3 * i, c) = rise.cwiseQuotient(sigma) / run;
    }
  }
  return jacobian;
}

VectorXl RelativeSingularValues(const MatrixXl& matrix) {
  const VectorXl values = Eigen::JacobiSVD<MatrixXl>(matrix).singularValues();
  return values / values[0];
}

std::vector<int> IndependentColumns(const Arm& arm, const VectorXl& values,
                                    const Dataset& data, long double fraction) {
  std::vector<int> all;
  for (int column = 0; column < 5 * arm.num_joints(); ++column) {
    all.push_back(column);
  }
  const MatrixXl jacobian = LinearizeReference(arm, values, data, all).jacobian;
  std::vector<int> independent;
  MatrixXl basis(jacobian.rows(), 0);
  for (const int column : all) {
    VectorXl rest = jacobian.col(column);
    for (int pass = 0; pass < 2; ++pass) {
      rest -= basis * (basis.transpose() * rest).eval();
    }
    if (!(rest.norm() > fraction * jacobian.col(column).norm())) continue;
    independent.push_back(column);
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols<1>() = rest.normalized();
  }
  return independent;
}

double LargestError(const Arm& arm, const Eigen::VectorXd& values,
                    const Dataset& data) {
  long double largest = 0.0L;
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const Vector3l error = MatrixPosition(arm, values.cast<long double>(),
                                          data.joint_values.col(i).data()) -
                           data.positions().col(i).cast<long double>();
    largest = std::max(largest, error.norm());
  }
  return static_cast<double>(largest);
}

MatrixXl ReferenceCovariance(const MatrixXl& jacobian, const VectorXl& prior) {
  MatrixXl normal = jacobian.transpose() * jacobian;
  normal.diagonal() += prior.cwiseInverse().cwiseAbs2();
  const VectorXl scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXl scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

ReferenceSolution SolveReference(const Arm& arm, const VectorXl& start,
                                 const Dataset& data,
                                 const std::vector<int>& columns) {
  constexpr int kMaxIterations = 30;
  // Long double leaves steps of 1e-19 times the condition; this is far above
  // and far below anything compared with the solution.
  constexpr long double kLastStep = 1e-14L;
  ReferenceSolution solution;
  solution.values = start;
  for (int k = 0; k < kMaxIterations && !solution.converged; ++k) {
    const ReferenceLinearization at =
        LinearizeReference(arm, solution.values, data, columns);
    const VectorXl step = at.jacobian.householderQr().solve(at.residuals);
    for (Eigen::Index c = 0; c < step.size(); ++c) {
      solution.values[columns[c]] -= step[c];
    }
    solution.converged = step.norm() < kLastStep;
  }
  const ReferenceLinearization at =
      LinearizeReference(arm, solution.values, data, columns);
  solution.cost = at.residuals.squaredNorm();
  const MatrixXl normal = at.jacobian.transpose() * at.jacobian;
  solution.stddevs = normal.inverse().diagonal().cwiseSqrt();
  return solution;
}

}  // namespace alidade::internal::testing
