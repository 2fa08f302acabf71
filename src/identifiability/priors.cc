#include "alidade/identifiability/priors.h"

#include <array>
#include <cmath>
#include <sstream>
#include <utility>

namespace alidade {

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
