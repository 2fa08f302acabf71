#ifndef ALIDADE_SRC_PLANNING_LINK_CAPSULES_H_
#define ALIDADE_SRC_PLANNING_LINK_CAPSULES_H_

#include <Eigen/Core>

#include "alidade/arm.h"
#include "alidade/plan.h"

namespace alidade::internal {

struct Segment {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
};

/// The least distance between points of two segments, which may be points.
double SegmentDistance(const Segment& a, const Segment& b);

/// The radius that links have where none is stated (m): a twentieth of all
/// lengths of the chain together.
double TypicalLinkRadius(const Arm& arm);

/// Pairs of links whose capsules overlap at one of the poses (n x N). A link
/// is the segment between the origins of consecutive joints, the last one ends
/// at the first target. Left out are links without length, neighbours, and
/// links that are joined by less than two radii of the chain, which overlap
/// at any pose.
LinkCaution FindLinkOverlaps(const Arm& arm,
                             const Eigen::MatrixXd& joint_values,
                             double radius);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_LINK_CAPSULES_H_
