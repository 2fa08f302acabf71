#include "src/dataio/orientation_cells.h"

#include <Eigen/Geometry>
#include <cmath>

#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

constexpr double kQuaternionNorm = 1e-3;

}  // namespace

std::optional<Eigen::Matrix3d> RotationOfQuaternion(
    const Eigen::Vector4d& wxyz) {
  const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(quaternion.norm() - 1.0) <= kQuaternionNorm)) {
    return std::nullopt;
  }
  return quaternion.normalized().toRotationMatrix();
}

Eigen::Matrix3d RotationOfVector(const Eigen::Vector3d& vector) {
  return RotationFromVector<double>(vector);
}

Eigen::Vector3d MeasuredVector(const Eigen::Matrix3d& rotation) {
  return VectorFromRotation(rotation);
}

}  // namespace alidade::internal
