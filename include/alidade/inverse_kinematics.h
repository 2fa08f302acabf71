#ifndef ALIDADE_INVERSE_KINEMATICS_H_
#define ALIDADE_INVERSE_KINEMATICS_H_

#include <Eigen/Core>
#include <optional>

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

/// True where every joint value is within its limits.
bool IsWithinLimits(const Arm& arm, const Eigen::VectorXd& joint_values);

}  // namespace alidade

#endif  // ALIDADE_INVERSE_KINEMATICS_H_
