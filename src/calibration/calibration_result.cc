#include "alidade/calibration_result.h"

#include <algorithm>
#include <cmath>

namespace alidade {

SharedVector EvaluatedSet::ErrorBefore() const {
  return residual_before.map().colwise().norm().transpose();
}

SharedVector EvaluatedSet::ErrorAfter() const {
  return residual_after.map().colwise().norm().transpose();
}

double StudyParameter::ErrorPercent(double deviation) const {
  if (assumed == 0.0) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * std::abs(deviation - assumed) / std::abs(assumed);
}

bool CalibrationResult::accepted() const {
  return std::all_of(acceptance.begin(), acceptance.end(),
                     [](const AcceptanceCheck& check) { return check.met(); });
}

}  // namespace alidade
