#include "alidade/calibration_options.h"

#include <sstream>

#include "src/calibration/calibration_options_fields.h"
#include "src/uncertainty/uncertainty_fields.h"

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
  if (!internal::AreFieldsValid(uncertainty, "uncertainty.", error) ||
      !internal::AreFieldsValid(errors, "errors.", error) ||
      !internal::AreFieldsValid(acceptance, "acceptance.", error) ||
      (holdout && !internal::AreFieldsValid(*holdout, "holdout.", error)) ||
      (folds && !internal::AreFieldsValid(*folds, "folds.", error))) {
    return false;
  }
  if (num_threads < 1) {
    return fail("num_threads = ", num_threads, ", must be 1 or more");
  }
  if (solver == SolverName::kPseudoInverse) {
    if (loss != LossKind::kNone) {
      return fail("loss must be none with the solver pseudo_inverse");
    }
    if (!bounds.empty()) {
      return fail("bounds must be empty with the solver pseudo_inverse");
    }
  }
  for (const ParameterBounds& bound : bounds) {
    if (bound.lower < bound.upper) continue;
    return fail("bounds of ", bound.parameter, " = [", bound.lower, ", ",
                bound.upper, "], expected the lower one first");
  }
  return true;
}

}  // namespace alidade
