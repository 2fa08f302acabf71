#ifndef ALIDADE_SRC_CALIBRATION_PREPARED_TASK_H_
#define ALIDADE_SRC_CALIBRATION_PREPARED_TASK_H_

#include <optional>
#include <vector>

#include "src/calibration/calibration_task.h"
#include "src/calibration/sigma_estimation.h"
#include "src/calibration/station_frames.h"
#include "src/uncertainty/lack_of_fit.h"

namespace alidade::internal {

/// Data that fit nowhere, and would if one mistake were mended, are an error of
/// the input, before anything is fitted. Returns what speaks against others.
std::optional<Finding> RefuseMistakes(const CalibrationTask& task);

/// A task as its solve sees it, and how it came there.
struct Prepared {
  CalibrationTask task;
  std::optional<Finding> misfit;  ///< what speaks against the input
  bool frames_fitted = false;
  /// Whose measurements are in the frame of the first one.
  std::vector<MovedStation> stations = {};
  EstimatedSigmas sigmas;
  StatedNoise stated_noise;
  std::optional<PriorScaling> prior_scaling;
};

/// Aligns stations, fits frames, estimates sigmas and the scale of priors as
/// the task's options say. @throws InputError.
Prepared Prepare(CalibrationTask task);

/// The same of a task whose stations are aligned and whose data were searched
/// for mistakes.
Prepared PrepareAligned(CalibrationTask task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PREPARED_TASK_H_
