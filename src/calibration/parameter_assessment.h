#ifndef ALIDADE_SRC_CALIBRATION_PARAMETER_ASSESSMENT_H_
#define ALIDADE_SRC_CALIBRATION_PARAMETER_ASSESSMENT_H_

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Fills in how every parameter of a result came to its value.
void AssessParameters(CalibrationResult* result);

/// The standard deviation of a parameter: computed, else predicted; NaN where
/// nothing is known of it.
double KnownStd(const CalibrationResult& result,
                const ParameterResult& parameter);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PARAMETER_ASSESSMENT_H_
