#include "alidade/rotation.h"

#include <cmath>

namespace alidade {

template Eigen::Matrix3d RotationFromVector<double>(const Eigen::Vector3d& w);
template Eigen::Vector3d VectorFromRotation<double>(
    const Eigen::Matrix3d& rotation);

Eigen::Matrix3d LeftJacobianOfRotation(const Eigen::Vector3d& w) {
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

Eigen::Matrix3d InverseLeftJacobianOfRotation(const Eigen::Vector3d& w) {
  const double angle_squared = w.squaredNorm();
  double e = 1.0 / 12.0 + angle_squared / 720.0;
  if (angle_squared > 1e-4) {
    const double angle = std::sqrt(angle_squared);
    const double half = 0.5 * angle;
    e = (1.0 - half * std::cos(half) / std::sin(half)) / angle_squared;
  } else {
    e += angle_squared * angle_squared / 30240.0;
  }
  Eigen::Matrix3d skew;
  skew << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return Eigen::Matrix3d::Identity() - 0.5 * skew + e * skew * skew;
}

}  // namespace alidade
