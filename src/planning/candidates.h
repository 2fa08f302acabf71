#ifndef ALIDADE_SRC_PLANNING_CANDIDATES_H_
#define ALIDADE_SRC_PLANNING_CANDIDATES_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/arm.h"
#include "alidade/plan.h"
#include "alidade/workspace_box.h"

namespace alidade::internal {

/// Whether the nominal arm satisfies the constraints at these joint values (n).
bool IsAllowedPose(const Arm& arm, const PoseConstraints& constraints,
                   const Eigen::VectorXd& joint_values);

/// Columns of `joint_values` (n x N) that satisfy the constraints, in order.
std::vector<int> AllowedPoses(const Arm& arm,
                              const PoseConstraints& constraints,
                              const Eigen::MatrixXd& joint_values);

/// Whether each box, and there is one, is farther from the base than ArmReach
/// by a tenth, so that no draw would find a pose in one of them. Never where a
/// slide has no limits of its own.
bool AreOutOfReach(const Arm& arm, const std::vector<WorkspaceBox>& boxes);

struct Candidates {
  Eigen::MatrixXd joint_values;  ///< n x found
  std::int64_t draws = 0;        ///< so many were drawn to find them
};

/// Joint values drawn within the limits that satisfy the constraints. Draw k
/// comes from stream k of the seed. Fewer than `count`, or none, where
/// count * max_draws draws do not find them. Joints without limits draw
/// from a turn, or the reach to both sides. O(draws n).
/// @pre count >= 1, max_draws >= 1.
Candidates DrawCandidates(const Arm& arm, const PoseConstraints& constraints,
                          const CandidateOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_CANDIDATES_H_
