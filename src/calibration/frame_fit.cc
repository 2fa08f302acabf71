#include "src/calibration/frame_fit.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "src/calibration/evaluate.h"
#include "src/calibration/preparation.h"
#include "src/identifiability/generic_data.h"
#include "src/initialization/initial_frames.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Observations of each kind that a start is found from; the fit takes all.
constexpr Eigen::Index kEnoughForStart = 1000;

// Frames as stated that leave errors below this part of the arm's reach are
// near enough to start from. A start that is found instead may be anywhere
// along what these poses do not determine, where the arm as stated is the
// better guess.
constexpr double kNear = 0.01;

// How far frames that were fitted at the nominal geometry may be from where
// they are.
constexpr double kMisplacedLength = 0.05;  // m
constexpr double kMisplacedAngle = 0.05;   // rad

double MedianError(const MeasurementModel& model, const Dataset& data) {
  std::vector<double> errors =
      InOrder(model.communicator(), data,
              CountedLengths(model.Errors(model.NominalValues(), data), data));
  return ComputeOnRoot(model.communicator(), data, [&] {
    if (errors.empty()) return std::numeric_limits<double>::infinity();
    const auto middle =
        errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  });
}

}  // namespace

bool HasUnknownFrames(const CalibrationTask& task) {
  const auto is_unknown = [](const auto& reference) {
    return !reference.is_known;
  };
  const References& references = task.data.references;
  return task.options.identifiability.candidates.base ||
         task.options.identifiability.candidates.tool ||
         std::any_of(references.points.begin(), references.points.end(),
                     is_unknown) ||
         std::any_of(references.planes.begin(), references.planes.end(),
                     is_unknown);
}

bool FitFrames(CalibrationTask* task) {
  if (!HasUnknownFrames(*task) || task->options.true_values) return false;
  IdentifiabilityOptions& options = task->options.identifiability;
  const Dataset& data = task->data.training;
  const Execution execution = task->execution();
  bool is_found = false;
  const MeasurementModel stated(task->arm, task->data.references, execution);
  const bool holds_part = !FramesOnly(options, stated.layout()).fix.empty();
  const bool is_near =
      MedianError(stated, data) < kNear * ArmReach(stated.nominal());
  if (!holds_part && !is_near) {
    InitialFrames start =
        FindInitialFrames(task->arm, task->data.references,
                          EvenSubset(task->communicator, data, kEnoughForStart),
                          options.candidates);
    const MeasurementModel found(start.arm, start.references, execution);
    if (MedianError(found, data) < MedianError(stated, data)) {
      task->arm = std::move(start.arm);
      task->data.references = std::move(start.references);
      is_found = true;
    }
  }
  const MeasurementModel model(task->arm, task->data.references, execution);
  const Fit fit = FitPart(*task, model, FramesOnly(options, model.layout()));
  // A start that was found stays better than none.
  if (!fit.summary.IsSolutionUsable()) return is_found;
  task->arm = model.layout().WithValues(task->arm, fit.values);
  task->data.references = model.ReferencesAt(fit.values);
  // From here on frames are known better than before: the nominal geometry
  // misplaces them by a multiple of its own error, not by metres.
  PriorTolerances& priors = options.priors;
  const PriorTolerances unknown;
  if (priors.frame_length == unknown.frame_length) {
    priors.frame_length = kMisplacedLength;
  }
  if (priors.frame_angle == unknown.frame_angle) {
    priors.frame_angle = kMisplacedAngle;
  }
  return true;
}

}  // namespace alidade::internal
