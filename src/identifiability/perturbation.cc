#include "src/identifiability/perturbation.h"

#include <cstdint>

#include "src/common/random.h"

namespace alidade::internal {

Eigen::VectorXd PerturbedValues(const MeasurementModel& model, double size,
                                int draw) {
  const double reach = ArmReach(model.nominal());
  Eigen::VectorXd sizes = model.NominalValues();
  for (int c = 0; c < sizes.size(); ++c) {
    const Parameter& parameter = model.layout().parameter(c);
    const bool angle = parameter.dimension == Dimension::kAngle;
    const bool moves = ParameterLayout::IsJointKind(parameter.kind);
    sizes[c] = moves ? size * (angle ? 1.0 : reach) : 0.0;
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
