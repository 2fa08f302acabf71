#ifndef ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_
#define ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_

#include "alidade/parameter_layout.h"
#include "src/calibration/job_config.h"

namespace alidade::internal {

/// Base, targets and references alone, the geometry of the joints held at its
/// nominal values.
IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options,
                                  const ParameterLayout& layout);

/// Whether base, targets or references are to be found at all.
bool HasUnknownFrames(const JobConfig& config);

/// Puts base, targets and references that are to be identified where they fit
/// the training data at the nominal geometry, from a start that needs no guess
/// of the user's (frame_start.h), so that the small rotations of the layout are
/// small: a rotation vector is a chart of SO(3) about the nominal one. Their
/// priors become 50 mm and 50 mrad about these places, unless they are
/// narrower. Nothing is done where the true arm is given, whose deviations are
/// from the arm as it stands. True: they were fitted, or at least found.
bool FitFrames(JobConfig* config, const Execution& execution);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FRAME_FIT_H_
