#include "src/calibration/prepared_task.h"

#include <array>
#include <utility>

#include "alidade/error.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/plausibility.h"
#include "src/calibration/prior_scale.h"
#include "src/calibration/sigma_change.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// What is known of the measurement alone, in variances of the fit's sigmas.
StatedNoise NoiseOver(const std::array<double, 2>& stated,
                      const CalibrationTask& task) {
  if (!task.options.estimate_sigma) return std::array<double, 2>{1.0, 1.0};
  std::array<double, 2> ratio{1.0, 1.0};
  for (std::size_t k = 0; k < 2; ++k) {
    const double used =
        MedianSigma(k == 0 ? RowClass::kLength : RowClass::kRotation,
                    task.data.training, task.communicator);
    if (used > 0.0) ratio[k] = (stated[k] / used) * (stated[k] / used);
  }
  return ratio;
}

}  // namespace

std::optional<Finding> RefuseMistakes(const CalibrationTask& task) {
  InputDiagnosis diagnosis =
      DiagnoseInput(task.arm, task.data.training,
                    task.options.identifiability.candidates, task.communicator,
                    task.data.validation ? &*task.data.validation : nullptr);
  if (!diagnosis.is_explained) return diagnosis.finding;
  SourceLocation location;
  location.file = task.data.training.name;
  throw InputError(location, diagnosis.finding->sentence);
}

Prepared Prepare(CalibrationTask task) {
  std::vector<MovedStation> stations = AlignStations(&task);
  std::optional<Finding> misfit = RefuseMistakes(task);
  Prepared prepared = PrepareAligned(std::move(task));
  prepared.stations = std::move(stations);
  prepared.misfit = std::move(misfit);
  return prepared;
}

Prepared PrepareAligned(CalibrationTask task) {
  Prepared prepared;
  prepared.task = std::move(task);
  if (prepared.task.options.errors.selection != ErrorTermSelection::kNone) {
    // They are estimated anew.
    prepared.task.arm.errors.Clear();
  }
  prepared.frames_fitted = FitFrames(&prepared.task);
  const CalibrationTask& given = prepared.task;
  const Dataset& training = given.data.training;
  const bool is_stated =
      !given.options.estimate_sigma ||
      SumOverRanks(given.communicator, training,
                   given.options.sigmas_are_stated ? 1 : 0) > 0;
  std::array<double, 2> stated{};
  if (is_stated && given.options.estimate_sigma) {
    stated = {MedianSigma(RowClass::kLength, training, given.communicator),
              MedianSigma(RowClass::kRotation, training, given.communicator)};
  }
  const CalibrationTask as_stated = prepared.task;
  if (as_stated.options.estimate_sigma) {
    prepared.sigmas = EstimateSigmas(&prepared.task);
  }
  if (prepared.task.options.prior_scale == PriorScale::kEstimated) {
    prepared.prior_scaling =
        EstimatePriors(as_stated, &prepared.task, &prepared.sigmas);
  }
  if (is_stated) prepared.stated_noise = NoiseOver(stated, prepared.task);
  return prepared;
}

}  // namespace alidade::internal
