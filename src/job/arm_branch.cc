#include "src/job/arm_branch.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

struct Axis {
  Eigen::Vector3d point;
  Eigen::Vector3d direction;
};

using Axes = std::array<Axis, 6>;

Axes AxesOf(const Arm& arm, const Eigen::VectorXd& joints) {
  ChainAxes chain;
  ComputeChainAxes(arm, joints.data(), &chain);
  Axes axes;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    axes[j] = {chain.origin_on_axis.col(column), chain.joint_axis.col(column)};
  }
  return axes;
}

// The point of axis a that is nearest to axis b. @pre they are not parallel.
Eigen::Vector3d NearestPoint(const Axis& a, const Axis& b) {
  const Eigen::Vector3d normal = a.direction.cross(b.direction);
  const double along =
      (b.point - a.point).cross(b.direction).dot(normal) / normal.squaredNorm();
  return a.point + along * a.direction;
}

double Distance(const Axis& axis, const Eigen::Vector3d& point) {
  return (point - axis.point).cross(axis.direction).norm();
}

// How far the wrist centre is in front of axis 1 and of the lower arm, but for
// a sign that is the arm's own.
struct WristPlace {
  double before_axis_1;
  double before_arm;
};

std::optional<WristPlace> PlaceOfWrist(const Axes& axes) {
  constexpr double kSame = 1e-3;  // m, and of 1
  const Axis& second = axes[1];
  const bool is_usual =
      std::abs(axes[0].direction.dot(second.direction)) < kSame &&
      second.direction.cross(axes[2].direction).norm() < kSame &&
      axes[3].direction.cross(axes[4].direction).norm() > kSame;
  if (!is_usual) return std::nullopt;
  const Eigen::Vector3d wrist = NearestPoint(axes[3], axes[4]);
  if (Distance(axes[4], wrist) > kSame || Distance(axes[5], wrist) > kSame) {
    return std::nullopt;
  }
  return WristPlace{
      (wrist - axes[0].point).dot(second.direction.cross(axes[0].direction)),
      (axes[2].point - second.point)
          .cross(wrist - axes[2].point)
          .dot(second.direction)};
}

}  // namespace

std::optional<int> ArmBranch(const Arm& arm, const Eigen::VectorXd& joints) {
  if (arm.num_joints() != 6) return std::nullopt;
  for (const Joint& joint : arm.joints) {
    if (joint.type != JointType::kRevolute) return std::nullopt;
  }
  const auto home = PlaceOfWrist(AxesOf(arm, Eigen::VectorXd::Zero(6)));
  const auto place = PlaceOfWrist(AxesOf(arm, joints));
  if (!home || !place) return std::nullopt;
  return (place->before_axis_1 * home->before_axis_1 < 0.0 ? 4 : 0) +
         (place->before_arm * home->before_arm < 0.0 ? 2 : 0) +
         (joints[4] < 0.0 ? 1 : 0);
}

std::string BranchMeaning(int branch) {
  const bool is_behind = (branch & 4) != 0;
  const bool is_behind_arm = (branch & 2) != 0;
  return std::string("wrist centre ") + (is_behind ? "behind" : "in front of") +
         " axis 1 and " + (is_behind_arm ? "behind" : "in front of") +
         " the lower arm, axis 5 " +
         ((branch & 1) != 0 ? "negative" : "positive");
}

}  // namespace alidade::internal
