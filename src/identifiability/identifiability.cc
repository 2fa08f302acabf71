#include "alidade/identifiability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

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

double PriorTolerances::Of(ParameterKind kind) const {
  switch (kind) {
    case ParameterKind::kBeta:
      return beta;
    case ParameterKind::kAlpha:
      return alpha;
    case ParameterKind::kD:
      return d;
    case ParameterKind::kTheta:
      return theta;
    case ParameterKind::kR:
      return r;
    case ParameterKind::kBaseTranslation:
    case ParameterKind::kToolTranslation:
    case ParameterKind::kPoint:
    case ParameterKind::kPlaneOffset:
      return frame_length;
    case ParameterKind::kBaseRotation:
    case ParameterKind::kToolRotation:
    case ParameterKind::kPlaneTilt:
      return frame_angle;
  }
  return 0.0;
}

Eigen::VectorXd PriorTolerances::Deviations(
    const ParameterLayout& layout) const {
  Eigen::VectorXd deviations(layout.size());
  for (int c = 0; c < layout.size(); ++c) {
    deviations[c] = Of(layout.parameter(c).kind);
  }
  return deviations;
}

bool PriorTolerances::IsValid(std::string* error) const {
  const std::array<std::pair<const char*, double>, 7> fields = {
      {{"beta", beta},
       {"alpha", alpha},
       {"d", d},
       {"theta", theta},
       {"r", r},
       {"frame_length", frame_length},
       {"frame_angle", frame_angle}}};
  for (const auto& [name, value] : fields) {
    if (std::isfinite(value) && value > 0.0) continue;
    std::ostringstream out;
    out << name << " = " << value << ", must be a finite number above 0";
    *error = out.str();
    return false;
  }
  return true;
}

}  // namespace alidade

namespace alidade {

double RankReport::SmallestCounted() const {
  return rank > 0 ? singular_values[rank - 1] : 1.0;
}

double RankReport::MiddleOfGap() const {
  double below = std::numeric_limits<double>::epsilon();
  if (rank < singular_values.size()) {
    below = std::max(below, singular_values[rank]);
  }
  return std::sqrt(SmallestCounted() * below);
}

const char* ToString(ParameterState state) {
  switch (state) {
    case ParameterState::kFree:
      return "free";
    case ParameterState::kFrozen:
      return "frozen";
    case ParameterState::kGiven:
      return "given";
  }
  return "unknown";
}

}  // namespace alidade
