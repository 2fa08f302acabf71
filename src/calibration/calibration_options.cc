#include "alidade/calibration_options.h"

#include <sstream>

namespace alidade {

bool CalibrationOptions::IsValid(std::string* error) const {
  const auto fail = [error](const auto&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    *error = text.str();
    return false;
  };
  if (!identifiability.IsValid(error) || !solver_options.IsValid(error)) {
    return false;
  }
  if (num_threads < 1) {
    return fail("num_threads = ", num_threads, ", expected at least 1");
  }
  if (holdout && !(holdout->fraction > 0.0 && holdout->fraction < 1.0)) {
    return fail("holdout.fraction = ", holdout->fraction,
                ", expected a number between 0 and 1");
  }
  if (folds && folds->folds < 2) {
    return fail("folds.folds = ", folds->folds, ", expected at least 2");
  }
  if (!(uncertainty.confidence > 0.0 && uncertainty.confidence < 1.0)) {
    return fail("uncertainty.confidence = ", uncertainty.confidence,
                ", expected a number between 0 and 1");
  }
  for (const ParameterBounds& bound : bounds) {
    if (bound.lower < bound.upper) continue;
    return fail("bounds of ", bound.parameter, " = [", bound.lower, ", ",
                bound.upper, "], expected the lower one first");
  }
  return true;
}

}  // namespace alidade
