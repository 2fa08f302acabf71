#ifndef ALIDADE_SRC_CALIBRATION_GUIDANCE_H_
#define ALIDADE_SRC_CALIBRATION_GUIDANCE_H_

#include <vector>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// What someone who is to use the arm asks besides whether it may be used. The
/// findings decide nothing: they are passed, and `next` says what to do.
///
///   "accuracy"          how accurate the arm is: errors at the poses that the
///                       result is judged by, and predicted over the workspace
///   "worst_place"       where it is predicted to be least accurate, in the
///                       frame of its base, and where it was measured to be so
///   "next_measurement"  what is to be measured next, and why; several, the
///                       most useful first
///
/// What a result does not have (the map of the workspace, joint limits,
/// observations that were not read back) is left out.
std::vector<Finding> GuidanceOf(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_GUIDANCE_H_
