#ifndef ALIDADE_MODEL_ROTATION_H_
#define ALIDADE_MODEL_ROTATION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace alidade {

/// Exp: the rotation matrix of a rotation vector w (rad), by Rodrigues'
/// formula R = I + a [w]x + b [w]x^2, a = sin|w| / |w|,
/// b = (1 - cos|w|) / |w|^2. Where |w|^2 is below 1e-12 the Taylor series of a
/// and b take over, exact to rounding there and with the right derivatives at
/// w = 0, so that T may be an autodiff scalar.
template <typename T>
Eigen::Matrix<T, 3, 3> RotationFromVector(const Eigen::Matrix<T, 3, 1>& w) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T angle_squared = w.squaredNorm();
  T a = T(1.0) - angle_squared / T(6.0);
  T b = T(0.5) - angle_squared / T(24.0);
  if (angle_squared > T(1e-12)) {
    const T angle = sqrt(angle_squared);
    const T half_sine = sin(T(0.5) * angle);
    a = sin(angle) / angle;
    // 1 - cos loses digits for small angles; the half angle does not.
    b = T(2.0) * half_sine * half_sine / angle_squared;
  }
  Eigen::Matrix<T, 3, 3> skew;
  skew << T(0.0), -w.z(), w.y(), w.z(), T(0.0), -w.x(), -w.y(), w.x(), T(0.0);
  return Eigen::Matrix<T, 3, 3>::Identity() + a * skew + b * skew * skew;
}

/// Log: the rotation vector of a rotation matrix, |w| <= pi.
inline Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

}  // namespace alidade

#endif  // ALIDADE_MODEL_ROTATION_H_
