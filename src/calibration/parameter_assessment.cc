#include "src/calibration/parameter_assessment.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace alidade::internal {
namespace {

// Beyond this part of the information a prior dominates.
constexpr double kDominantPrior = 0.5;

// The uncertainty of a parameter; null where it has none.
const ParameterUncertainty* UncertaintyOf(const CalibrationResult& result,
                                          const std::string& name) {
  if (!result.uncertainty) return nullptr;
  for (const ParameterUncertainty& one : result.uncertainty->parameters) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

ParameterAssessment Assess(const CalibrationResult& result,
                           const ParameterResult& parameter) {
  const ParameterDecision& decision = parameter.decision;
  if (decision.state == ParameterState::kGiven) {
    return ParameterAssessment::kKnown;
  }
  if (decision.state == ParameterState::kFixed) {
    return ParameterAssessment::kFixed;
  }
  const ParameterUncertainty* const known =
      UncertaintyOf(result, parameter.name);
  const double std = KnownStd(result, parameter);
  double prior_share = 0.0;
  if (known != nullptr) {
    prior_share = known->prior_share;
  } else if (!std::isfinite(parameter.std)) {
    prior_share = std * std / (decision.prior_std * decision.prior_std);
  }
  if (prior_share > kDominantPrior) return ParameterAssessment::kPriorDominated;
  // result.json has no infinity: of a result that was read back, none where
  // other parameters have one.
  const bool others_have_one =
      std::any_of(result.parameters.begin(), result.parameters.end(),
                  [](const ParameterResult& other) {
                    return std::isfinite(other.decision.predicted_std);
                  });
  const std::vector<std::string>& weak = result.identifiability.weak;
  const bool is_weak =
      std::isinf(std) || (std::isnan(std) && others_have_one) ||
      std::find(weak.begin(), weak.end(), parameter.name) != weak.end();
  return is_weak ? ParameterAssessment::kWeak : ParameterAssessment::kEstimated;
}

}  // namespace

void AssessParameters(CalibrationResult* result) {
  for (ParameterResult& parameter : result->parameters) {
    parameter.assessment = Assess(*result, parameter);
  }
}

double KnownStd(const CalibrationResult& result,
                const ParameterResult& parameter) {
  const ParameterUncertainty* const known =
      UncertaintyOf(result, parameter.name);
  if (known != nullptr) return known->std;
  return std::isfinite(parameter.std) ? parameter.std
                                      : parameter.decision.predicted_std;
}

}  // namespace alidade::internal
