#ifndef ALIDADE_SRC_IDENTIFIABILITY_PERTURBATION_H_
#define ALIDADE_SRC_IDENTIFIABILITY_PERTURBATION_H_

#include <Eigen/Core>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// The nominal values with every joint parameter, and base and tool where they
/// are candidates, moved by up to options.perturbation (rad for angles, times
/// the reach for lengths). Draws are the same for every seed of the user: what
/// is read off a perturbed geometry must not depend on it.
Eigen::VectorXd PerturbedValues(const MeasurementModel& model,
                                const IdentifiabilityOptions& options,
                                int draw);

/// The same with a size of its own for each column of the layout.
Eigen::VectorXd PerturbedValues(const MeasurementModel& model,
                                const Eigen::VectorXd& sizes, int draw);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_PERTURBATION_H_
