#ifndef ALIDADE_BATCHED_KINEMATICS_H_
#define ALIDADE_BATCHED_KINEMATICS_H_

#include <Eigen/Core>

#include "alidade/arm.h"

namespace alidade {

/// Kinematics of many configurations, one per column: joint values are n x N
/// (rad or m). Poses are those of a target (from 0) in the instrument's frame.
/// Costs O(N n); threads do not change the bits. @pre num_threads >= 1.
using JointValues = Eigen::Ref<const Eigen::MatrixXd>;

/// Positions (3 x N, m).
Eigen::Matrix3Xd BatchedPositions(const Arm& arm, const JointValues& joints,
                                  int target = 0, int num_threads = 1);

/// Homogeneous matrices (16 x N): a column holds one row after the other.
Eigen::MatrixXd BatchedTransforms(const Arm& arm, const JointValues& joints,
                                  int target = 0, int num_threads = 1);

/// Geometric Jacobians (6 n x N): a column holds, joint after joint, what a
/// joint moves the target's origin by (m/rad or 1) and the vector that it turns
/// the target about (rad/rad or rad/m), both along the instrument's axes
/// (Whitney 1972). Error terms are where they are at these joint values; that
/// they change with them is left out.
Eigen::MatrixXd BatchedJointJacobians(const Arm& arm, const JointValues& joints,
                                      int target = 0, int num_threads = 1);

/// The same by all parameters of the arm, column after column of its
/// ParameterLayout (6 p x N): the identification Jacobian. Loads of error terms
/// stay where they are.
Eigen::MatrixXd BatchedParameterJacobians(const Arm& arm,
                                          const JointValues& joints,
                                          int target = 0, int num_threads = 1);

}  // namespace alidade

#endif  // ALIDADE_BATCHED_KINEMATICS_H_
