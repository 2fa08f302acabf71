#include "alidade/identifiability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/identifiability/identifiability_fields.h"

namespace alidade {

bool IdentifiabilityOptions::IsValid(std::string* error) const {
  return internal::AreFieldsValid(*this, "", error);
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
  return internal::AreFieldsValid(*this, "", error);
}

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
    case ParameterState::kFixed:
      return "fixed";
    case ParameterState::kGiven:
      return "given";
  }
  return "unknown";
}

}  // namespace alidade
