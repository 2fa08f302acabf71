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

// A straight line with an even turn.
struct Line {
  Eigen::Isometry3d from;
  Eigen::Isometry3d to;

  Eigen::Isometry3d At(double fraction) const {
    const Eigen::Quaterniond turn_from(from.linear());
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() =
        from.translation() + fraction * (to.translation() - from.translation());
    pose.linear() = turn_from.slerp(fraction, Eigen::Quaterniond(to.linear()))
                        .toRotationMatrix();
    return pose;
  }

  double Steps() const {
    const Eigen::Quaterniond turn_from(from.linear());
    const Eigen::Quaterniond turn_to(to.linear());
    return std::clamp(
        std::ceil(std::max(
            (to.translation() - from.translation()).norm() / kLongestStep,
            turn_from.angularDistance(turn_to) / kLargestTurn)),
        kFewestSteps, kMostSteps);
  }
};

struct PlaceOnLine {
  double fraction;
  Eigen::VectorXd joints;
};

// Whether joints stay where they are as the step shrinks within which the
// branch changes: a singular pose is crossed then. Beside one, the way keeps
// its branch by turning joints fast, and the other branch is another posture.
bool Crosses(const Arm& arm, const Line& line, PlaceOnLine before,
             PlaceOnLine after, const PoseSolverOptions& options) {
  constexpr int kNumCuts = 6;
  constexpr double kPart = 0.45;  // not at a singular pose half way
  constexpr double kSame = 3.0 * kDegree;
  for (int k = 0; k < kNumCuts; ++k) {
    const double fraction =
        before.fraction + kPart * (after.fraction - before.fraction);
    const PoseSolutions cut =
        SolvePoses(arm, {line.At(fraction)}, before.joints, options);
    const PlaceOnLine place{fraction, cut.joint_values.col(0)};
    if (cut.status[0] == PoseStatus::kReached) {
      before = place;
    } else if (cut.status[0] == PoseStatus::kBranchChange) {
      after = place;
    } else {
      break;
    }
  }
  return LargestChange(before.joints, after.joints) < kSame;
}

}  // namespace

StraightWay FollowStraightWay(const Arm& arm, const Eigen::VectorXd& from,
                              const Eigen::Isometry3d& to,
                              const PoseSolverOptions& options) {
  const PoseSolverOptions coarse = Coarse(options);
  const Line line{TargetPose(arm, from), to};
  const auto steps = static_cast<int>(line.Steps());
  StraightWay way;
  way.joint_values = from;
  way.fraction = 0.0;
  for (int step = 1; step <= steps; ++step) {
    const double fraction = static_cast<double>(step) / steps;
    const PoseSolutions next =
        SolvePoses(arm, {line.At(fraction)}, way.joint_values, coarse);
    way.status = next.status[0];
    const bool is_near =
        LargestChange(next.joint_values.col(0), way.joint_values) <=
        coarse.max_joint_change;
    // Singular poses may be crossed where no joint turns fast.
    if (way.status == PoseStatus::kBranchChange && is_near &&
        Crosses(arm, line, {way.fraction, way.joint_values},
                {fraction, next.joint_values.col(0)}, coarse)) {
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
