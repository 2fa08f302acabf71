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

/// The left Jacobian of SO(3), J(w) = I + b [w]x + c [w]x^2,
/// b = (1 - cos|w|) / |w|^2, c = (|w| - sin|w|) / |w|^3: the axes that a
/// rotation turns about, on the left, when its vector's components grow, Exp(w
/// + e) = Exp(J(w) e) Exp(w) to first order. Chirikjian 2012, "Stochastic
/// Models, Information Theory, and Lie Groups 2", eq. 10.86.
inline Eigen::Matrix3d LeftJacobianOfRotation(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  double b = 0.5 - angle_squared / 24.0;
  double c = 1.0 / 6.0 - angle_squared / 120.0;
  // Below, the closed forms lose more digits than the series leaves out.
  if (angle_squared > 1e-4) {
    const double angle = std::sqrt(angle_squared);
    const double half_sine = std::sin(0.5 * angle);
    b = 2.0 * half_sine * half_sine / angle_squared;
    c = (angle - std::sin(angle)) / (angle * angle_squared);
  } else {
    b += angle_squared * angle_squared / 720.0;
    c += angle_squared * angle_squared / 5040.0;
  }
  Eigen::Matrix3d skew;
  skew << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return Eigen::Matrix3d::Identity() + b * skew + c * skew * skew;
}

/// Log: the rotation vector of a rotation matrix, |w| <= pi.
inline Eigen::Vector3d VectorFromRotation(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

}  // namespace alidade

#endif  // ALIDADE_MODEL_ROTATION_H_
