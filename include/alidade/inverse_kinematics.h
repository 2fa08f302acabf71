#ifndef ALIDADE_INVERSE_KINEMATICS_H_
#define ALIDADE_INVERSE_KINEMATICS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "alidade/arm.h"

namespace alidade {

/// Where the target should be, and, where asked, the direction of the last
/// joint's z axis; both in the instrument's frame.
struct PointingTask {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< (m)
  std::optional<Eigen::Vector3d> direction;            ///< unit vector
};

struct InverseKinematicsOptions {
  int max_iterations = 200;           ///< >= 1
  double position_tolerance = 1e-9;   ///< (m) > 0
  double direction_tolerance = 1e-9;  ///< (rad) > 0
};

/// Joint values that fulfil the task within the arm's limits, found from
/// `start` by damped least squares (Wampler 1986, "Manipulator inverse
/// kinematic solutions based on vector formulations and damped least-squares
/// methods"; the damping shrinks with the remaining error). A joint that the
/// task does not depend on keeps its start value; the start chooses among
/// postures.
///
/// Nothing, where no such values are found from this start: out of reach, or
/// outside the limits. Cost: some ten geometric Jacobians.
/// @pre start has one value per joint; direction, if any, has norm 1.
std::optional<Eigen::VectorXd> SolveInverseKinematics(
    const Arm& arm, const PointingTask& task, const Eigen::VectorXd& start,
    const InverseKinematicsOptions& options = {});

/// What of a target's pose is asked for. What an arm has no freedom for is
/// brought as near as the rest allows.
enum class PoseTask {
  /// kPose for six joints and more; for fewer the position, then the direction
  /// of the target's z axis, then the rotation about it.
  kAutomatic,
  kPose,      ///< position and orientation alike; six joints and more
  kAxis,      ///< position, then the direction of the target's z axis
  kPosition,  ///< position alone
};

enum class PoseStatus {
  kReached,       ///< what is asked for is within the tolerances
  kOutOfReach,    ///< or so near a singular pose that damping stopped it
  kLimit,         ///< a joint limit keeps the target away
  kBranchChange,  ///< reached, but not in the posture of the start
};

/// "reached", "out of reach", "joint limit", "branch change".
const char* ToString(PoseStatus status);

struct PoseSolverOptions {
  PoseTask task = PoseTask::kAutomatic;
  int target = 0;                     ///< number of the arm's target
  int max_iterations = 60;            ///< >= 1
  double position_tolerance = 5e-10;  ///< (m) > 0
  double rotation_tolerance = 1e-9;   ///< (rad) > 0
  /// What a joint may move from its start before the answer counts as another
  /// posture (rad; of prismatic joints in parts of the arm's reach). What a
  /// calibration changes is some 0.01.
  double max_joint_change = 0.5;
  int num_threads = 1;
};

/// Answers to many targets: one entry or column each.
struct PoseSolutions {
  Eigen::MatrixXd joint_values;  ///< n x N, within the limits
  std::vector<PoseStatus> status;
  Eigen::VectorXd position_error;  ///< what is left (m)
  /// What is left of the orientation (rad), also where it is not asked for.
  Eigen::VectorXd rotation_error;
  std::vector<int> iterations;
};

/// Joint values that bring the arm's target to poses in the instrument's frame,
/// with all that the arm's model has: geometry, elasticity, joint functions,
/// coupling. Column i of `starts` (n x N) is where target i starts from: for a
/// calibrated arm the solution of the nominal one.
///
/// With x the task's error, position over the arm's reach and rotation vector
/// (rad), and J its derivative by the joint values,
///
///   q <- q + J^-1 x                                     six joints
///   q <- q + J^T (J J^T + mu I)^-1 x                    near singular poses
///   q <- q + J^+ x + (I - J^+ J) (start - q)            more than six
///
/// so that redundant joints stay nearest to their start; mu is that of
/// Levenberg and Marquardt, zero while steps bring the target nearer. Tasks of
/// several parts take each in the null space of those before (Siciliano and
/// Slotine 1991, "A general framework for managing multiple tasks"), along
/// directions that joints move by at least 0.1 rad per rad. Joints that a step
/// takes beyond a limit stay at it.
///
/// Branches: the determinant of J has the sign that it had at the start, and no
/// joint has moved by more than max_joint_change.
///
/// Cost: two to four evaluations of the model, 1 to 4 microseconds for six
/// joints; nothing is allocated for a target. Threads do not change the bits.
/// @pre starts is n x targets.size().
PoseSolutions SolvePoses(const Arm& arm,
                         const std::vector<Eigen::Isometry3d>& targets,
                         const Eigen::MatrixXd& starts,
                         const PoseSolverOptions& options = {});

/// The same without starts: each target starts at the answer before it, the
/// first one at `start`, and, where that does not reach it, at up to
/// `num_trials` postures drawn within the limits from `seed`. The posture is
/// free (max_joint_change is not used).
PoseSolutions FindPoses(const Arm& arm,
                        const std::vector<Eigen::Isometry3d>& targets,
                        const Eigen::VectorXd& start, int num_trials,
                        std::uint64_t seed,
                        const PoseSolverOptions& options = {});

/// Half way between the limits; 0 of a joint without limits.
Eigen::VectorXd MiddleOfLimits(const Arm& arm);

/// True where every joint value is within its limits.
bool IsWithinLimits(const Arm& arm, const Eigen::VectorXd& joint_values);

}  // namespace alidade

#endif  // ALIDADE_INVERSE_KINEMATICS_H_
