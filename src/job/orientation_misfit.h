#ifndef ALIDADE_SRC_JOB_ORIENTATION_MISFIT_H_
#define ALIDADE_SRC_JOB_ORIENTATION_MISFIT_H_

#include <optional>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// How far the orientations of a data set are off those of the nominal arm
/// (rad), wherever base and tool are: the angle of the turn from one pose to
/// another is the same in every frame. The median of how the two angles differ,
/// over neighbours or over poses half of the data apart, whichever is larger;
/// nothing of fewer than six.
std::optional<double> OrientationMisfit(const Arm& arm, const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ORIENTATION_MISFIT_H_
