#ifndef ALIDADE_FORWARD_KINEMATICS_H_
#define ALIDADE_FORWARD_KINEMATICS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "alidade/arm.h"
#include "alidade/error_terms.h"
#include "alidade/parameter_layout.h"
#include "alidade/rotation.h"

namespace alidade {

/// The one definition of the model: forward kinematics as a template over the
/// scalar, which may be double, long double or an autodiff type.
///
/// A point is carried from the target to the instrument, joint by joint from
/// the inside out:
///
///   p(j-1) = Rot(y, beta) Rot(x, alpha) (d e_x + Rot(z, theta) (p(j) + r e_z))
///
/// which costs three plane rotations of one vector per joint (12
/// multiplications), where a product of 4 x 4 matrices takes more than 100:
/// for autodiff scalars this is most of the cost of a calibration.
template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// The parameters of a layout, block by block: n values each, then base and
/// tool with six (translation, rotation vector on the left of the nominal
/// rotation). `base` and `tool` may be null: the arm's own are used. `tool` is
/// the block of target number `target`.
template <typename T>
struct GeometryView {
  const T* beta = nullptr;
  const T* alpha = nullptr;
  const T* d = nullptr;
  const T* theta = nullptr;
  const T* r = nullptr;
  const T* base = nullptr;
  const T* tool = nullptr;
  int target = 0;
};

/// The blocks of a vector with one value per column of the layout. The view
/// lives as long as `values`.
template <typename T>
GeometryView<T> ViewOf(const ParameterLayout& layout, const T* values,
                       int target = 0) {
  const auto block = [&](ParameterKind kind, int object = 0) {
    return values + layout.Column(kind, 0, object);
  };
  return {block(ParameterKind::kBeta),
          block(ParameterKind::kAlpha),
          block(ParameterKind::kD),
          block(ParameterKind::kTheta),
          block(ParameterKind::kR),
          block(ParameterKind::kBaseTranslation),
          block(ParameterKind::kToolTranslation, target),
          target};
}

/// Rotates (a, b) by the angle whose sine and cosine are given, a towards b.
template <typename T>
void RotatePlane(const T& sine, const T& cosine, T* a, T* b) {
  const T rotated = cosine * *a - sine * *b;
  *b = sine * *a + cosine * *b;
  *a = rotated;
}

/// Turns by 2 atan(tilt / 2) instead (error_terms.h).
template <typename T>
void TiltPlane(double tilt, T* a, T* b) {
  const double quarter = 0.25 * tilt * tilt;
  const double scale = 1.0 / (1.0 + quarter);
  RotatePlane<T>(T(tilt * scale), T((1.0 - quarter) * scale), a, b);
}

/// Turns a vector in frame j by the tilts of joint j.
template <typename T>
void TiltVector(const PoseErrors& errors, int j, T* v) {
  TiltPlane<T>(errors.tilts(1, j), v + 2, v);
  TiltPlane<T>(errors.tilts(0, j), v + 1, v + 2);
}

/// What is carried from frame to frame: a point, and the columns of `axes`,
/// directions, where that is not null.
template <typename T>
struct CarriedPoint {
  Vector3<T>* point;
  Eigen::Matrix<T, 3, 3>* axes = nullptr;
};

/// Carries from frame j (index `j` from 0) to frame j - 1. `errors`: of the
/// pose, null for a rigid arm.
template <typename T>
void CarryThroughJoint(const Arm& arm, const GeometryView<T>& geometry, int j,
                       double q, const PoseErrors* errors,
                       const CarriedPoint<T>& carried) {
  using std::cos;
  using std::sin;
  T theta = geometry.theta[j];
  T r = geometry.r[j];
  if (errors != nullptr) q += errors->shifts[j];
  if (arm.joints[j].type == JointType::kRevolute) {
    theta += q;
  } else {
    r += q;
  }
  Eigen::Matrix<T, 3, 3>* const axes = carried.axes;
  T& x = carried.point->x();
  T& y = carried.point->y();
  T& z = carried.point->z();
  z += r;
  if (errors != nullptr) {
    TiltVector(*errors, j, carried.point->data());
    for (int k = 0; axes != nullptr && k < 3; ++k) {
      TiltVector(*errors, j, axes->col(k).data());
    }
  }
  const T sin_theta = sin(theta), cos_theta = cos(theta);
  const T sin_alpha = sin(geometry.alpha[j]),
          cos_alpha = cos(geometry.alpha[j]);
  const T sin_beta = sin(geometry.beta[j]), cos_beta = cos(geometry.beta[j]);
  RotatePlane<T>(sin_theta, cos_theta, &x, &y);
  x += geometry.d[j];
  RotatePlane<T>(sin_alpha, cos_alpha, &y, &z);
  RotatePlane<T>(sin_beta, cos_beta, &z, &x);
  if (axes == nullptr) return;
  for (int k = 0; k < 3; ++k) {
    T* const axis = axes->col(k).data();
    RotatePlane<T>(sin_theta, cos_theta, axis, axis + 1);
    RotatePlane<T>(sin_alpha, cos_alpha, axis + 1, axis + 2);
    RotatePlane<T>(sin_beta, cos_beta, axis + 2, axis);
  }
}

/// Moves a point, or with is_direction only turns a direction, from a frame as
/// covariates move it (PoseErrors::base, target) to that frame.
template <typename T>
void CarryThroughMotion(const Eigen::Matrix<double, 6, 1>& motion, T* v,
                        bool is_direction) {
  TiltPlane<T>(motion[5], v, v + 1);
  TiltPlane<T>(motion[4], v + 2, v);
  TiltPlane<T>(motion[3], v + 1, v + 2);
  for (int k = 0; k < 3 && !is_direction; ++k) v[k] += motion[k];
}

/// The error terms of an arm at a pose, or nothing for a rigid one.
class ErrorsOfPose {
 public:
  ErrorsOfPose(const Arm& arm, const double* joint_values,
               const double* covariates = nullptr) {
    if (!arm.errors.empty()) errors_ = ErrorsAt(arm, joint_values, covariates);
  }
  const PoseErrors* get() const { return errors_ ? &*errors_ : nullptr; }

 private:
  std::optional<PoseErrors> errors_;
};

/// Position of the target's origin in the instrument's frame (m).
/// `joint_values`: n values, rad or m; `covariates`: as ErrorsAt takes them.
/// Cost: O(n), no allocation but for error terms.
template <typename T>
Vector3<T> TargetPosition(const Arm& arm, const GeometryView<T>& geometry,
                          const double* joint_values,
                          const double* covariates = nullptr) {
  Vector3<T> point =
      arm.last_from_target(geometry.target).translation().template cast<T>();
  if (geometry.tool != nullptr) {
    point = Eigen::Map<const Vector3<T>>(geometry.tool);
  }
  const ErrorsOfPose errors(arm, joint_values, covariates);
  if (errors.get() != nullptr) {
    CarryThroughMotion(errors.get()->target, point.data(), false);
  }
  for (int j = arm.num_joints() - 1; j >= 0; --j) {
    CarryThroughJoint<T>(arm, geometry, j, joint_values[j], errors.get(),
                         {&point});
  }
  if (errors.get() != nullptr) {
    CarryThroughMotion(errors.get()->base, point.data(), false);
  }
  point = arm.instrument_from_base.linear().template cast<T>() * point;
  if (geometry.base == nullptr) {
    return point + arm.instrument_from_base.translation().template cast<T>();
  }
  const Eigen::Map<const Vector3<T>> translation(geometry.base);
  const Vector3<T> rotation = Eigen::Map<const Vector3<T>>(geometry.base + 3);
  return RotationFromVector<T>(rotation) * point + translation;
}

/// The same, and the target's orientation: `axes` receives the columns of the
/// rotation from the target's frame to the instrument's.
template <typename T>
Vector3<T> TargetPose(const Arm& arm, const GeometryView<T>& geometry,
                      const double* joint_values,
                      Eigen::Matrix<T, 3, 3>* instrument_from_target,
                      const double* covariates = nullptr) {
  const Eigen::Isometry3d& tool = arm.last_from_target(geometry.target);
  Vector3<T> point = tool.translation().template cast<T>();
  Eigen::Matrix<T, 3, 3> rotation = tool.linear().template cast<T>();
  if (geometry.tool != nullptr) {
    point = Eigen::Map<const Vector3<T>>(geometry.tool);
    const Vector3<T> turn = Eigen::Map<const Vector3<T>>(geometry.tool + 3);
    rotation = RotationFromVector<T>(turn) * rotation;
  }
  const ErrorsOfPose errors(arm, joint_values, covariates);
  const auto carry = [&](const Eigen::Matrix<double, 6, 1>& motion) {
    CarryThroughMotion(motion, point.data(), false);
    for (int k = 0; k < 3; ++k) {
      CarryThroughMotion(motion, rotation.col(k).data(), true);
    }
  };
  if (errors.get() != nullptr) carry(errors.get()->target);
  for (int j = arm.num_joints() - 1; j >= 0; --j) {
    CarryThroughJoint<T>(arm, geometry, j, joint_values[j], errors.get(),
                         {&point, &rotation});
  }
  if (errors.get() != nullptr) carry(errors.get()->base);
  Eigen::Matrix<T, 3, 3> base =
      arm.instrument_from_base.linear().template cast<T>();
  Vector3<T> origin = arm.instrument_from_base.translation().template cast<T>();
  if (geometry.base != nullptr) {
    origin = Eigen::Map<const Vector3<T>>(geometry.base);
    const Vector3<T> turn = Eigen::Map<const Vector3<T>>(geometry.base + 3);
    base = RotationFromVector<T>(turn) * base;
  }
  *instrument_from_target = base * rotation;
  return base * point + origin;
}

/// Pose of a target in the instrument's frame at joint values (n values, rad
/// or m). O(n).
Eigen::Isometry3d TargetPose(const Arm& arm,
                             const Eigen::VectorXd& joint_values,
                             int target = 0);

/// Positions (3 x N, m) of a target in the instrument's frame at joint values
/// (n x N). O(N n).
Eigen::Matrix3Xd TargetPositions(const Arm& arm,
                                 const Eigen::MatrixXd& joint_values,
                                 int target = 0);

}  // namespace alidade

#endif  // ALIDADE_FORWARD_KINEMATICS_H_
