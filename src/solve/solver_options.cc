#include "alidade/solver_options.h"

#include <cmath>
#include <sstream>

namespace alidade {
namespace {

// Comparisons are written so that NaN fails them.
template <typename Value>
bool Require(bool holds, const char* field, Value value, const char* constraint,
             std::string* error) {
  if (holds) return true;
  std::ostringstream out;
  out << field << " = " << value << ", must be " << constraint;
  *error = out.str();
  return false;
}

bool IsFiniteNonNegative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

}  // namespace

bool SolverOptions::IsValid(std::string* error) const {
  const char* non_negative = "a finite number of 0 or more";
  return Require(max_iterations >= 1, "max_iterations", max_iterations,
                 "1 or more", error) &&
         Require(IsFiniteNonNegative(function_tolerance), "function_tolerance",
                 function_tolerance, non_negative, error) &&
         Require(IsFiniteNonNegative(rounding_floor_factor),
                 "rounding_floor_factor", rounding_floor_factor, non_negative,
                 error) &&
         Require(IsFiniteNonNegative(wanted_precision), "wanted_precision",
                 wanted_precision, non_negative, error) &&
         Require(IsFiniteNonNegative(initial_trust_region_radius),
                 "initial_trust_region_radius", initial_trust_region_radius,
                 "above 0, or 0 for automatic", error) &&
         Require(
             pseudo_inverse_tolerance >= 0.0 && pseudo_inverse_tolerance < 1.0,
             "pseudo_inverse_tolerance", pseudo_inverse_tolerance,
             "between 0 (automatic) and 1", error) &&
         Require(num_threads >= 1, "num_threads", num_threads, "1 or more",
                 error);
}

}  // namespace alidade
