#ifndef ALIDADE_SRC_CALIBRATION_ACCEPTANCE_H_
#define ALIDADE_SRC_CALIBRATION_ACCEPTANCE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Errors of the poses left out of the fit, or of each fold, without rejected
/// observations; n = 0 without poses held out.
struct ValidationErrors {
  Accuracy lengths;
  Accuracy rotations;
  std::int64_t num_rejected = 0;
};
ValidationErrors ValidationErrorsOf(const CalibrationResult& result);

/// Each limit that is asked for beside what was obtained. A limit on what was
/// not measured is missed.
std::vector<AcceptanceCheck> CheckAcceptance(const AcceptanceLimits& limits,
                                             const CalibrationResult& result);

/// "validation_max 0.071 mm, at most 0.01 mm; ...": the limits that are missed.
std::string MissedLimits(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_ACCEPTANCE_H_
