#ifndef ALIDADE_SRC_CALIBRATION_OWN_REFERENCES_H_
#define ALIDADE_SRC_CALIBRATION_OWN_REFERENCES_H_

#include <string>

#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// Counts unknown points and planes that validation poses alone are measured
/// against as known where they are: no training pose says anything of them.
/// True where there are any. Collective.
bool HoldOwnReferences(CalibrationTask* task);

/// Finds them from the validation data, with the arm held that the training
/// data calibrate: for the task they are known then. Returns a sentence that
/// says so; empty where there are none, and nothing is fitted. Takes a
/// calibration more. Collective. @throws InputError where the validation data
/// do not determine them.
std::string FitOwnReferences(CalibrationTask* task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_OWN_REFERENCES_H_
