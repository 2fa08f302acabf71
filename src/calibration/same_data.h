#ifndef ALIDADE_SRC_CALIBRATION_SAME_DATA_H_
#define ALIDADE_SRC_CALIBRATION_SAME_DATA_H_

#include <vector>

#include "alidade/calibration_result.h"
#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// What to warn of where measurements are there twice, joint values and
/// measured values to the last bit: in the data (a file and its copy), or in
/// the data and the validation, which is none then. Noise makes no two
/// measurements alike, whatever the files are called. Nothing of a part of the
/// data, and of more than a million observations. The statistic is the fraction
/// of measurements that are there twice.
std::vector<Finding> DiagnoseSameData(const CalibrationTask& task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_SAME_DATA_H_
