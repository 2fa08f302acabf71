#include "src/job/posture_search.h"

#include <algorithm>
#include <cmath>

#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"

namespace alidade::internal {
namespace {

constexpr double kLongestStep = 10.0 * kMillimetre;
constexpr double kLargestTurn = 2.0 * kDegree;
constexpr double kFewestSteps = 5.0;
constexpr double kMostSteps = 2000.0;
constexpr int kNumTrials = 100;
constexpr double kSamePosture = 0.5 * kDegree;

// What a controller interpolates with, not what positions are solved to.
PoseSolverOptions Coarse(const PoseSolverOptions& options) {
  PoseSolverOptions coarse;
  coarse.task = options.task;
  coarse.target = options.target;
  return coarse;
}

double LargestChange(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace

StraightWay FollowStraightWay(const Arm& arm, const Eigen::VectorXd& from,
                              const Eigen::Isometry3d& to,
                              const PoseSolverOptions& options) {
  const PoseSolverOptions coarse = Coarse(options);
  const Eigen::Isometry3d start = TargetPose(arm, from);
  const Eigen::Quaterniond turn_from(start.linear());
  const Eigen::Quaterniond turn_to(to.linear());
  const double steps = std::clamp(
      std::ceil(std::max(
          (to.translation() - start.translation()).norm() / kLongestStep,
          turn_from.angularDistance(turn_to) / kLargestTurn)),
      kFewestSteps, kMostSteps);
  StraightWay way;
  way.joint_values = from;
  way.fraction = 0.0;
  for (double step = 1.0; step <= steps; step += 1.0) {
    const double fraction = step / steps;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = start.translation() +
                         fraction * (to.translation() - start.translation());
    pose.linear() = turn_from.slerp(fraction, turn_to).toRotationMatrix();
    const PoseSolutions next =
        SolvePoses(arm, {pose}, way.joint_values, coarse);
    way.status = next.status[0];
    const bool is_near =
        LargestChange(next.joint_values.col(0), way.joint_values) <=
        coarse.max_joint_change;
    // Singular poses may be crossed where no joint turns fast.
    if (way.status == PoseStatus::kBranchChange && is_near) {
      way.status = PoseStatus::kReached;
    }
    if (way.status != PoseStatus::kReached) return way;
    way.joint_values = next.joint_values.col(0);
    way.fraction = fraction;
  }
  return way;
}

std::vector<Eigen::VectorXd> FindPostures(const Arm& arm,
                                          const Eigen::Isometry3d& pose,
                                          const Eigen::VectorXd& near,
                                          std::uint64_t seed,
                                          const PoseSolverOptions& options) {
  PoseSolverOptions free = Coarse(options);
  free.max_joint_change = std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd starts = DrawJointValues(arm, kNumTrials, seed);
  std::vector<Eigen::VectorXd> found;
  const PoseSolutions solutions = SolvePoses(
      arm, std::vector<Eigen::Isometry3d>(kNumTrials, pose), starts, free);
  for (int k = 0; k < kNumTrials; ++k) {
    const PoseStatus status = solutions.status[static_cast<std::size_t>(k)];
    if (status != PoseStatus::kReached && status != PoseStatus::kBranchChange) {
      continue;
    }
    Eigen::VectorXd joints = solutions.joint_values.col(k);
    for (int j = 0; j < arm.num_joints(); ++j) {
      const Joint& joint = arm.joints[static_cast<std::size_t>(j)];
      if (joint.type != JointType::kRevolute) continue;
      const double turned =
          near[j] + std::remainder(joints[j] - near[j], 2.0 * kPi);
      if (turned >= joint.lower && turned <= joint.upper) joints[j] = turned;
    }
    const bool is_known =
        std::any_of(found.begin(), found.end(), [&](const auto& other) {
          return LargestChange(other, joints) < kSamePosture;
        });
    if (!is_known) found.push_back(joints);
  }
  std::stable_sort(found.begin(), found.end(),
                   [&](const auto& a, const auto& b) {
                     return (a - near).norm() < (b - near).norm();
                   });
  return found;
}

}  // namespace alidade::internal
