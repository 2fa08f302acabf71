#ifndef ALIDADE_SRC_JOB_POSTURE_SEARCH_H_
#define ALIDADE_SRC_JOB_POSTURE_SEARCH_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "alidade/arm.h"
#include "alidade/inverse_kinematics.h"

namespace alidade::internal {

/// How an arm goes along a straight line.
struct StraightWay {
  Eigen::VectorXd joint_values;  ///< at its end, or where it stops
  /// kReached: it arrives; kBranchChange: joints turn by more than
  /// max_joint_change within one step, as wrists do near singular poses.
  PoseStatus status = PoseStatus::kReached;
  double fraction = 1.0;  ///< of the way that is gone
};

/// Leads the arm's target from where it is at joint values `from` to a pose,
/// along a straight line with an even turn, in steps of at most 10 mm and 2
/// deg: each starts where the one before ends, as a controller's interpolation
/// does, which leaves a posture at a singular pose alone.
StraightWay FollowStraightWay(const Arm& arm, const Eigen::VectorXd& from,
                              const Eigen::Isometry3d& to,
                              const PoseSolverOptions& options);

/// Different joint values within the limits that reach a pose, those nearest to
/// `near` first. Each joint is within half a turn of there where its limits
/// allow it.
std::vector<Eigen::VectorXd> FindPostures(const Arm& arm,
                                          const Eigen::Isometry3d& pose,
                                          const Eigen::VectorXd& near,
                                          std::uint64_t seed,
                                          const PoseSolverOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_POSTURE_SEARCH_H_
