#ifndef ALIDADE_ROTATION_H_
#define ALIDADE_ROTATION_H_

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

/// The left Jacobian of SO(3), J(w) = I + b [w]x + c [w]x^2,
/// b = (1 - cos|w|) / |w|^2, c = (|w| - sin|w|) / |w|^3: the axes that a
/// rotation turns about, on the left, when its vector's components grow, Exp(w
/// + e) = Exp(J(w) e) Exp(w) to first order. Chirikjian 2012, "Stochastic
/// Models, Information Theory, and Lie Groups 2", eq. 10.86.
Eigen::Matrix3d LeftJacobianOfRotation(const Eigen::Vector3d& w);

/// The inverse of LeftJacobianOfRotation,
/// J(w)^-1 = I - [w]x / 2 + e [w]x^2, e = 1 / |w|^2 - cot(|w| / 2) / (2 |w|):
/// Log(Exp(e) R) = Log(R) + J(Log(R))^-1 e to first order. Finite up to half a
/// turn and beyond; undefined at a whole one. Chirikjian 2012, eq. 10.87.
Eigen::Matrix3d InverseLeftJacobianOfRotation(const Eigen::Vector3d& w);

/// Log of a rotation, |w| <= pi, for any scalar. By the quaternion (x, s) of
/// the rotation, from its largest component (Shepperd 1978, "Quaternion from
/// rotation matrix"): w = 2 atan2(|x|, s) x / |x|, exact to rounding for small
/// angles and for half a turn alike. Where |x|^2 is below 1e-14, the series
/// w = (2 + |x|^2 / 3) x of the arcsine takes over, with the right derivatives
/// at the identity.
template <typename T>
Eigen::Matrix<T, 3, 1> VectorFromRotation(
    const Eigen::Matrix<T, 3, 3>& rotation) {
  using std::atan2;
  using std::sqrt;
  const T trace = rotation.trace();
  Eigen::Matrix<T, 3, 1> x;
  T s;
  if (trace > T(0.0)) {
    s = T(0.5) * sqrt(trace + T(1.0));
    const T scale = T(0.25) / s;
    x << (rotation(2, 1) - rotation(1, 2)) * scale,
        (rotation(0, 2) - rotation(2, 0)) * scale,
        (rotation(1, 0) - rotation(0, 1)) * scale;
  } else {
    int i = rotation(1, 1) > rotation(0, 0) ? 1 : 0;
    if (rotation(2, 2) > rotation(i, i)) i = 2;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    x[i] = T(0.5) *
           sqrt(rotation(i, i) - rotation(j, j) - rotation(k, k) + T(1.0));
    const T scale = T(0.25) / x[i];
    s = (rotation(k, j) - rotation(j, k)) * scale;
    x[j] = (rotation(j, i) + rotation(i, j)) * scale;
    x[k] = (rotation(k, i) + rotation(i, k)) * scale;
    if (s < T(0.0)) {
      x = -x;
      s = -s;
    }
  }
  const T norm_squared = x.squaredNorm();
  if (norm_squared < T(1e-14)) return x * (T(2.0) + norm_squared / T(3.0));
  const T norm = sqrt(norm_squared);
  return x * (T(2.0) * atan2(norm, s) / norm);
}

// Of doubles, compiled once.
extern template Eigen::Matrix3d RotationFromVector<double>(
    const Eigen::Vector3d& w);
extern template Eigen::Vector3d VectorFromRotation<double>(
    const Eigen::Matrix3d& rotation);

/// Log: the rotation vector of a rotation matrix, |w| <= pi.
inline Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& rotation) {
  return VectorFromRotation<double>(rotation);
}

}  // namespace alidade

#endif  // ALIDADE_ROTATION_H_
