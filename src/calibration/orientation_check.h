#ifndef ALIDADE_SRC_CALIBRATION_ORIENTATION_CHECK_H_
#define ALIDADE_SRC_CALIBRATION_ORIENTATION_CHECK_H_

#include <Eigen/Core>

#include "src/calibration/calibration_task.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// Orientations that are misread (convention of the angles, their unit, order
/// of a quaternion) fit nowhere, while positions may fit well, since they weigh
/// more. Both throw InputError; neither does anything without orientations.

/// At the nominal geometry, with base and target found: half of them more than
/// 0.3 rad off.
void RequireOrientationsNearby(const MeasurementModel& model,
                               const CalibrationTask& task);

/// After calibration, at `values`: half of them more than 0.1 rad off, five
/// stated standard deviations, and ten times as much as positions over the
/// arm's reach. No arm is left with that whose positions fit.
void RequireOrientationsFit(const MeasurementModel& model,
                            const CalibrationTask& task,
                            const Eigen::VectorXd& values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_ORIENTATION_CHECK_H_
