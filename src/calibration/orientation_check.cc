#include "src/calibration/orientation_check.h"

#include <algorithm>
#include <string>

#include "alidade/error.h"
#include "alidade/units.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/sigma_change.h"
#include "src/common/format.h"

namespace alidade::internal {
namespace {

[[noreturn]] void Refuse(const CalibrationTask& task, const std::string& what) {
  SourceLocation location;
  location.file = task.data.training.name;
  throw InputError(
      location, what +
                    ". Look at the convention of the angles (`rotation`), "
                    "their unit, and the order of a quaternion's components");
}

std::string Degrees(double angle) {
  return FormatSignificant(angle / kDegree, 3) + " deg";
}

}  // namespace

void RequireOrientationsNearby(const MeasurementModel& model,
                               const CalibrationTask& task) {
  constexpr double kTolerated = 0.3;  // rad
  const Dataset& data = task.data.training;
  if (!data.Has(MeasurementKind::kPose)) return;
  const Accuracy before = EvaluateRotations(model, data, model.NominalValues());
  if (before.median < kTolerated) return;
  Refuse(task,
         "the measured orientations do not fit this arm, whatever its base and "
         "target: half of them are more than " +
             Degrees(before.median) + " off");
}

void RequireOrientationsFit(const MeasurementModel& model,
                            const CalibrationTask& task,
                            const Eigen::VectorXd& values) {
  constexpr double kTolerated = 0.1;  // rad; cameras are better by far
  constexpr double kSigmas = 5.0;
  constexpr double kTimesPositions = 10.0;
  const Dataset& data = task.data.training;
  if (!data.Has(MeasurementKind::kPose)) return;
  const Accuracy rotations = EvaluateRotations(model, data, values);
  // Estimated sigmas are what the misfit made of them.
  const double stated =
      task.options.estimate_sigma
          ? 0.0
          : MedianSigma(RowClass::kRotation, data, task.communicator);
  if (rotations.median < std::max(kTolerated, kSigmas * stated)) return;
  const Accuracy positions = EvaluateAccuracy(model, data, values);
  Arm at_origin = model.nominal();
  at_origin.instrument_from_base.setIdentity();
  const double as_angle = positions.median / Reach(at_origin);
  if (rotations.median < kTimesPositions * as_angle) return;
  Refuse(task,
         "after calibration half of the measured orientations are more "
         "than " +
             Degrees(rotations.median) +
             " off, while half of the positions are within " +
             FormatLength(positions.median, 3) +
             ": no arm does that, they are misread, or far less certain than "
             "their `sigma`");
}

}  // namespace alidade::internal
