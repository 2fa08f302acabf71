#ifndef ALIDADE_SRC_JOB_PROGRAM_ARMS_H_
#define ALIDADE_SRC_JOB_PROGRAM_ARMS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "alidade/arm.h"
#include "alidade/correction.h"

namespace alidade::internal {

/// The arms with a program's tool behind the flange.
CorrectionArms WithTool(const CorrectionArms& arms,
                        const Eigen::Isometry3d& flange_from_tool);

/// Limits narrowed to what a posture allows (motors, n x 2), where each motor
/// turns a joint of its own.
Arm WithBounds(const Arm& arm, const Eigen::MatrixXd& bounds);

/// Whether an arm of six joints and more is at a singular pose: where its
/// target cannot be moved in some direction.
bool IsSingular(const Arm& arm, const Eigen::VectorXd& joints);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_PROGRAM_ARMS_H_
