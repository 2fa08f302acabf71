#ifndef ALIDADE_SRC_CALIBRATION_CROSS_VALIDATION_H_
#define ALIDADE_SRC_CALIBRATION_CROSS_VALIDATION_H_

#include <optional>

#include "alidade/calibration_result.h"
#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// Calibrates without each of the task's folds in turn as without none: its
/// stations, frames, sigmas, priors and error terms anew. Pools the errors of
/// the poses held out. `kept`: the training data without what the fit to all of
/// them has rejected, where there is any. Nothing where one of the fits is not
/// usable, or where a fold is all that there is of a target, point or plane.
/// The cost of a calibration for each fold.
std::optional<CrossValidation> CrossValidate(
    const CalibrationTask& task, const std::optional<Dataset>& kept);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_CROSS_VALIDATION_H_
