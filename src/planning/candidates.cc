#include "src/planning/candidates.h"

#include <algorithm>
#include <cmath>

#include "alidade/units.h"
#include "src/common/random.h"
#include "src/model/chain_axes.h"
#include "src/model/joint_draw.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

bool KeepsClear(const std::vector<HalfSpace>& half_spaces,
                const Eigen::Vector3d& point) {
  return std::all_of(half_spaces.begin(), half_spaces.end(),
                     [&](const HalfSpace& half_space) {
                       return half_space.normal.dot(point) >=
                              half_space.offset + half_space.margin;
                     });
}

bool IsSeen(const Visibility& visibility,
            const Eigen::Isometry3d& base_from_target) {
  const Eigen::Vector3d way =
      visibility.instrument - base_from_target.translation();
  const Eigen::Vector3d axis = base_from_target.linear() * visibility.axis;
  return axis.dot(way) >= std::cos(visibility.angle) * way.norm();
}

// One of the limits, where there are any, or a value between them.
double DrawFaceValue(const Arm& arm, int j, Random* random) {
  const Joint& joint = arm.joints[j];
  const double inside = DrawJointValue(arm, j, random);
  const double choice = random->Uniform(0.0, 3.0);
  if (!HasLimits(joint)) return inside;
  if (choice < 1.0) return joint.lower;
  return choice < 2.0 ? joint.upper : inside;
}

// Motors' values with so many decimals, towards zero where rounding would go
// beyond a limit.
void RoundMotors(const Arm& arm, int decimals, Eigen::VectorXd* joints) {
  const double scale = std::pow(10.0, decimals);
  Eigen::VectorXd motors = MotorsFromJoints(arm, *joints);
  const bool is_direct = !HasMotorMap(arm);
  const std::vector<Dimension> dimensions = MotorDimensions(arm);
  for (Eigen::Index j = 0; j < motors.size(); ++j) {
    const Joint& joint = arm.joints[j];
    const bool turns = dimensions[j] == Dimension::kAngle;
    const bool is_limited = is_direct && HasLimits(joint);
    const auto in_unit = [&](double steps) {
      return turns ? steps / scale * kDegree : steps / (scale * 1000.0);
    };
    double steps =
        std::round(motors[j] / (turns ? kDegree : kMillimetre) * scale);
    if (is_limited && in_unit(steps) > joint.upper) steps -= 1.0;
    if (is_limited && in_unit(steps) < joint.lower) steps += 1.0;
    motors[j] = in_unit(steps);
  }
  *joints = JointsFromMotors(arm, motors);
}

}  // namespace

bool IsAllowedPose(const Arm& arm, const PoseConstraints& constraints,
                   const Eigen::VectorXd& joint_values) {
  if (constraints.empty()) return true;
  ChainAxes axes;
  ComputeChainAxes(arm, joint_values.data(), &axes);
  const Eigen::Isometry3d base_from_instrument =
      arm.instrument_from_base.inverse();
  // The first frame is where the arm is screwed down, or above it. Frame j ends
  // where joint j + 1 begins.
  for (int j = 2; j < arm.num_joints(); ++j) {
    if (!KeepsClear(constraints.half_spaces,
                    base_from_instrument * axes.origin_before.col(j))) {
      return false;
    }
  }
  const Eigen::Isometry3d base_from_last =
      base_from_instrument * axes.instrument_from_last;
  if (arm.num_joints() > 1 &&
      !KeepsClear(constraints.half_spaces, base_from_last.translation())) {
    return false;
  }
  for (const Target& target : arm.targets) {
    const Eigen::Vector3d point =
        base_from_last * target.last_from_target.translation();
    if (!KeepsClear(constraints.half_spaces, point)) return false;
  }
  return std::all_of(
      constraints.targets.begin(), constraints.targets.end(), [&](int target) {
        const Eigen::Isometry3d base_from_target =
            base_from_last * arm.last_from_target(target);
        return IsInside(constraints.boxes, base_from_target.translation()) &&
               (!constraints.visibility ||
                IsSeen(*constraints.visibility, base_from_target));
      });
}

std::vector<int> AllowedPoses(const Arm& arm,
                              const PoseConstraints& constraints,
                              const Eigen::MatrixXd& joint_values) {
  std::vector<int> allowed;
  for (Eigen::Index k = 0; k < joint_values.cols(); ++k) {
    if (IsAllowedPose(arm, constraints, joint_values.col(k))) {
      allowed.push_back(static_cast<int>(k));
    }
  }
  return allowed;
}

bool AreOutOfReach(const Arm& arm, const std::vector<WorkspaceBox>& boxes) {
  constexpr double kMargin = 1.1;  // errors may lengthen the arm
  // Joints that follow others may leave their limits.
  const bool may_follow = HasFewerMotors(arm);
  const bool is_endless = std::any_of(
      arm.joints.begin(), arm.joints.end(), [&](const Joint& joint) {
        return joint.type == JointType::kPrismatic &&
               (may_follow || !HasLimits(joint));
      });
  const double reach = kMargin * ArmReach(arm);
  return !boxes.empty() && !is_endless &&
         std::all_of(boxes.begin(), boxes.end(), [&](const WorkspaceBox& box) {
           const Eigen::Vector3d nearest =
               Eigen::Vector3d::Zero().cwiseMax(box.lower).cwiseMin(box.upper);
           return nearest.norm() > reach;
         });
}

Candidates DrawCandidates(const Arm& arm, const PoseConstraints& constraints,
                          const CandidateOptions& options) {
  Candidates candidates;
  candidates.joint_values.resize(arm.num_joints(), options.count);
  const std::int64_t limit =
      std::int64_t{options.count} * std::int64_t{options.max_draws};
  int found = 0;
  Eigen::VectorXd q(arm.num_joints());
  while (found < options.count && candidates.draws < limit) {
    Random random(options.seed, static_cast<std::uint64_t>(candidates.draws));
    const bool on_faces = options.limit_faces && candidates.draws % 2 == 1;
    ++candidates.draws;
    for (int j = 0; j < arm.num_joints(); ++j) {
      q[j] = on_faces ? DrawFaceValue(arm, j, &random)
                      : DrawJointValue(arm, j, &random);
    }
    RoundMotors(arm, options.joint_decimals, &q);
    if (IsAllowedPose(arm, constraints, q)) {
      candidates.joint_values.col(found++) = q;
    }
  }
  candidates.joint_values.conservativeResize(Eigen::NoChange, found);
  return candidates;
}

}  // namespace alidade::internal
