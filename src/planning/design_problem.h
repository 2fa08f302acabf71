#ifndef ALIDADE_SRC_PLANNING_DESIGN_PROBLEM_H_
#define ALIDADE_SRC_PLANNING_DESIGN_PROBLEM_H_

#include <Eigen/Core>
#include <vector>

#include "src/planning/pose_rows.h"

namespace alidade::internal {

/// Choose N of many poses so that a criterion of the information matrix
///
///   M = M0 + sum over the chosen poses k of J_k^T J_k
///
/// is largest: M^-1 is the covariance that a calibration from these poses has.
/// J_k are the whitened rows of a pose and M0 what is known without them, from
/// priors and from poses measured before.
struct DesignProblem {
  PoseRows candidates;
  /// M0, parameters x parameters in the scaled columns of `candidates`; zero
  /// where nothing is known.
  Eigen::MatrixXd known;
  /// G and I: position rows (m) where predictions are to be good, columns
  /// scaled like those of `candidates`; empty for other criteria.
  PoseRows region;
  /// n x candidates; only looked at where there is a minimum motion.
  Eigen::MatrixXd joint_values;
  /// Two poses of a plan differ by this or more in one joint (rad or m), n;
  /// empty: no such demand. Infinite entries are joints that do not count.
  Eigen::VectorXd minimum_motion;
};

/// The same problem with some of its candidates, in this order.
DesignProblem RestrictCandidates(const DesignProblem& problem,
                                 const std::vector<int>& candidates);

/// sum J_k^T J_k over the poses `chosen`.
Eigen::MatrixXd InformationOf(const PoseRows& rows,
                              const std::vector<int>& chosen);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_DESIGN_PROBLEM_H_
