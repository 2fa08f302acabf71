#include "src/dataio/inverse_pose.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "alidade/rotation.h"
#include "src/dataio/covariance.h"

namespace alidade::internal {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

Matrix6d CovarianceOf(const StatedObservation& pose) {
  if (pose.whitener.size() > 0) {
    return (pose.whitener.transpose() * pose.whitener).inverse();
  }
  const Eigen::Map<const Eigen::Matrix<double, 6, 1>> sigmas(
      pose.sigmas.data());
  return sigmas.cwiseAbs2().asDiagonal();
}

Eigen::Matrix3d CrossProduct(const Eigen::Vector3d& p) {
  Eigen::Matrix3d cross;
  cross << 0.0, -p.z(), p.y(), p.z(), 0.0, -p.x(), -p.y(), p.x(), 0.0;
  return cross;
}

}  // namespace

bool InvertPose(StatedObservation* pose) {
  if (!std::all_of(pose->sigmas.begin(), pose->sigmas.end(),
                   [](double sigma) { return std::isfinite(sigma); })) {
    return false;
  }
  Eigen::Map<Eigen::Vector3d> position(pose->measured.data());
  Eigen::Map<Eigen::Vector3d> vector(pose->measured.data() + 3);
  const Eigen::Matrix3d inverse =
      RotationFromVector<double>(Eigen::Vector3d(-vector));
  Matrix6d carried = Matrix6d::Zero();
  carried.topLeftCorner<3, 3>() = -inverse;
  carried.topRightCorner<3, 3>() = -inverse * CrossProduct(position);
  carried.bottomRightCorner<3, 3>() = -inverse;
  const std::optional<Noise> noise =
      CorrelatedNoise(carried * CovarianceOf(*pose) * carried.transpose(),
                      std::vector<bool>(6, true));
  if (noise) {
    std::copy_n(noise->sigmas.data(), 6, pose->sigmas.begin());
    pose->whitener = noise->whitener;
  }
  position = -(inverse * position).eval();
  vector = -vector.eval();
  return noise.has_value();
}

}  // namespace alidade::internal
