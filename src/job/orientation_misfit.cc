#include "src/job/orientation_misfit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"

namespace alidade::internal {
namespace {

double AngleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return VectorFromRotation(Eigen::Matrix3d(a.transpose() * b)).norm();
}

// Orientations at the poses of a data set.
struct Orientations {
  std::vector<Eigen::Matrix3d> measured;
  std::vector<Eigen::Matrix3d> modelled;
};

Orientations OrientationsOf(const Arm& arm, const Dataset& data) {
  Orientations all;
  for (const ObservationBlock& block : data.blocks) {
    if (block.kind != MeasurementKind::kPose) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const Eigen::Vector3d vector = block.measured.map().col(i).segment<3>(3);
      all.measured.emplace_back(RotationFromVector<double>(vector));
      all.modelled.push_back(
          TargetPose(arm, data.joint_values.map().col(block.pose(i)),
                     block.target(i))
              .linear());
    }
  }
  return all;
}

// Of turns from each pose to the one that comes so many later.
double MedianDifference(const Orientations& all, std::size_t later) {
  std::vector<double> differences;
  for (std::size_t i = 0; i + later < all.measured.size(); ++i) {
    differences.push_back(
        std::abs(AngleBetween(all.measured[i], all.measured[i + later]) -
                 AngleBetween(all.modelled[i], all.modelled[i + later])));
  }
  const auto half =
      differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), half, differences.end());
  return *half;
}

}  // namespace

std::optional<double> OrientationMisfit(const Arm& arm, const Dataset& data) {
  constexpr std::size_t kFewest = 6;
  const Orientations all = OrientationsOf(arm, data);
  if (all.measured.size() < kFewest) return std::nullopt;
  // Neighbours are often turned alike.
  return std::max(MedianDifference(all, 1),
                  MedianDifference(all, all.measured.size() / 2));
}

}  // namespace alidade::internal
