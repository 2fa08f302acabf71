#ifndef ALIDADE_SRC_MODEL_CHAIN_AXES_H_
#define ALIDADE_SRC_MODEL_CHAIN_AXES_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "alidade/arm.h"

namespace alidade::internal {

/// The lines that the parameters of each joint turn about or move along, in
/// the instrument's frame: what a geometric Jacobian is made of. Column j of
/// each matrix belongs to joint j + 1. With p the target,
///
///   dp/dbeta  = beta_axis   x (p - origin_before)
///   dp/dalpha = alpha_axis  x (p - origin_before)     dp/dd = alpha_axis
///   dp/dtheta = joint_axis  x (p - origin_on_axis)    dp/dr = joint_axis
///
/// (Whitney 1972, "The mathematics of coordinated control of prosthetic arms
/// and manipulators", for theta and r; the others follow alike). Error terms
/// bend the chain as they do anywhere; of the axis of r their small tilt is
/// left out.
struct ChainAxes {
  Eigen::Matrix3Xd beta_axis;
  Eigen::Matrix3Xd alpha_axis;
  Eigen::Matrix3Xd joint_axis;
  Eigen::Matrix3Xd origin_before;
  Eigen::Matrix3Xd origin_on_axis;
  Eigen::Isometry3d instrument_from_last = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d instrument_from_target = Eigen::Isometry3d::Identity();
};

/// Fills `axes` for an arm at `joint_values` (n values, rad or m). Allocates
/// only where `axes` has another number of joints. Cost: O(n).
void ComputeChainAxes(const Arm& arm, const double* joint_values,
                      ChainAxes* axes);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_MODEL_CHAIN_AXES_H_
