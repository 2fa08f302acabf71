#include "src/identifiability/perturbation.h"

#include <cstdint>

#include "src/common/random.h"

namespace alidade::internal {

namespace {

bool Moves(const IdentifiabilityOptions& options, ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kBaseTranslation:
    case ParameterKind::kBaseRotation:
      return options.candidates.base;
    case ParameterKind::kToolTranslation:
    case ParameterKind::kToolRotation:
      return options.candidates.tool;
    default:
      return ParameterLayout::IsJointKind(kind);
  }
}

}  // namespace

Eigen::VectorXd PerturbedValues(const MeasurementModel& model,
                                const IdentifiabilityOptions& options,
                                int draw) {
  const double reach = ArmReach(model.nominal());
  Eigen::VectorXd sizes = model.NominalValues();
  for (int c = 0; c < sizes.size(); ++c) {
    const Parameter& parameter = model.layout().parameter(c);
    const bool angle = parameter.dimension == Dimension::kAngle;
    sizes[c] = Moves(options, parameter.kind)
                   ? options.perturbation * (angle ? 1.0 : reach)
                   : 0.0;
  }
  return PerturbedValues(model, sizes, draw);
}

Eigen::VectorXd PerturbedValues(const MeasurementModel& model,
                                const Eigen::VectorXd& sizes, int draw) {
  constexpr std::uint64_t kSeed = 1;
  Random random(kSeed, static_cast<std::uint64_t>(draw));
  Eigen::VectorXd values = model.NominalValues();
  for (Eigen::Index c = 0; c < values.size(); ++c) {
    values[c] += sizes[c] * random.Uniform(-1.0, 1.0);
  }
  return values;
}

}  // namespace alidade::internal
