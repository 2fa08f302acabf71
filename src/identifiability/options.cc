#include "alidade/identifiability/options.h"

#include <sstream>

namespace alidade {
namespace {

// Comparisons are written so that NaN fails them.
bool Require(bool holds, const char* field, double value,
             const char* constraint, std::string* error) {
  if (holds) return true;
  std::ostringstream out;
  out << field << " = " << value << ", must be " << constraint;
  *error = out.str();
  return false;
}

}  // namespace

bool IdentifiabilityOptions::IsValid(std::string* error) const {
  return Require(angle_tolerance > 0.0 && angle_tolerance < 0.1,
                 "angle_tolerance", angle_tolerance,
                 "above 0 and below 0.1 rad", error) &&
         Require(relative_tolerance > 0.0 && relative_tolerance < 1.0,
                 "relative_tolerance", relative_tolerance,
                 "above 0 and below 1", error) &&
         Require(perturbation > 0.0 && perturbation < 0.5, "perturbation",
                 perturbation, "above 0 and below 0.5", error) &&
         priors.IsValid(error);
}

}  // namespace alidade
