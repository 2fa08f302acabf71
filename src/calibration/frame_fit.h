#ifndef ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_
#define ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_

#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// Whether base, targets or references are to be found at all.
bool HasUnknownFrames(const CalibrationTask& task);

/// Puts base, targets and references that are to be identified where they fit
/// the training data at the nominal geometry, from a start that needs no guess
/// of the user's (frame_start.h), so that the small rotations of the layout are
/// small: a rotation vector is a chart of SO(3) about the nominal one. Their
/// priors become 50 mm and 50 mrad about these places, unless they are
/// narrower. Nothing is done where the true arm is given, whose deviations are
/// from the arm as it stands. True: they were fitted, or at least found.
bool FitFrames(CalibrationTask* task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_
