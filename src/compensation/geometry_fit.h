#ifndef ALIDADE_SRC_COMPENSATION_GEOMETRY_FIT_H_
#define ALIDADE_SRC_COMPENSATION_GEOMETRY_FIT_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"

namespace alidade::internal {

/// Which of beta, alpha, d, theta, r (rows) of each joint (columns) may change.
using FreeGeometry = Eigen::Array<bool, 5, Eigen::Dynamic>;

/// `start` with its free numbers so that its poses are nearest to those of
/// `real` over the workspace: least squares of positions and, a tenth of the
/// reach away, orientations at configurations drawn within the joint limits.
/// What no pose distinguishes stays as it is. Both arms have as many joints.
Arm FitGeometry(const Arm& real, const Arm& start, const FreeGeometry& free);

/// Distance of the targets of two arms over the workspace (m).
Accuracy DistanceOver(const Arm& real, const Arm& other);

/// The same without error terms, which no table of numbers holds.
Arm WithoutErrorTerms(Arm arm);

/// Poses of each joint's frame in the one before at joint values of zero, the
/// first one in the instrument's frame: with its rotation or travel after it,
/// each is what URDF calls an origin (r moves along the joint's own axis).
std::vector<Eigen::Isometry3d> JointOrigins(const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMPENSATION_GEOMETRY_FIT_H_
