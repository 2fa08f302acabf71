#ifndef ALIDADE_SRC_CALIBRATION_CALIBRATION_TASK_H_
#define ALIDADE_SRC_CALIBRATION_CALIBRATION_TASK_H_

#include <Eigen/Core>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"
#include "alidade/communicator.h"

namespace alidade::internal {

class IdentifiabilityCache;

/// The arguments of a calibration as one value, which its preparation changes
/// step by step: frames move to where they fit, sigmas to what the residuals
/// say.
struct CalibrationTask {
  Arm arm;
  CalibrationData data;
  CalibrationOptions options;
  /// Ranks that have a part of the data each (partition.h); all else is the
  /// same on all of them. Calibrate is then collective, and every rank finds
  /// what one process would, to the bit, but for what has an entry for each
  /// pose, observation or outlier, which the root alone has.
  Communicator* communicator = SingleProcess();
  /// Where a robust solve begins, near its solution; empty: at nominal.
  Eigen::VectorXd start = {};

  Execution execution() const { return {options.num_threads, communicator}; }
};

/// Checks options and data against each other and the arm, and splits the
/// training data as `options.holdout` says, unless there are validation data
/// already. What every use of a task begins with. @throws InputError.
void CheckAndHoldOut(CalibrationTask* task);

/// Calibrate of calibration.h. Data are not copied where the task is moved in.
/// `cache`: null, or what calibrations of one arm and the same poses share; the
/// result is the same.
CalibrationResult Calibrate(CalibrationTask task,
                            IdentifiabilityCache* cache = nullptr);

/// AnalyzeIdentifiability of calibration.h.
IdentifiabilityResult AnalyzeTask(CalibrationTask task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_CALIBRATION_TASK_H_
