#ifndef ALIDADE_SRC_DATAIO_INVERSE_POSE_H_
#define ALIDADE_SRC_DATAIO_INVERSE_POSE_H_

#include "src/dataio/observation_table.h"

namespace alidade::internal {

/// Turns the pose of a fixed target in the frame of a camera on the arm, p and
/// R, into that of the camera in the frame of the target, -R^T p and R^T, and
/// carries its noise over. With dp and the small turn t of the measured pose on
/// the left, to first order,
///
///   dp' = -R^T dp - R^T [p] t,    t' = -R^T t,
///
/// [p] being the cross product with p: positions take up what the orientation
/// is off by times the distance.
/// False, and nothing is changed, where not all six rows were measured.
bool InvertPose(StatedObservation* pose);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_INVERSE_POSE_H_
