#ifndef ALIDADE_SRC_SIMULATION_SIMULATION_H_
#define ALIDADE_SRC_SIMULATION_SIMULATION_H_

#include <string>

#include "alidade/dataset.h"
#include "src/calibration/job_config.h"

namespace alidade::internal {

/// Measures the real arm of a simulation: plans the poses with the nominal arm
/// (inverse kinematics, random draws or a file), rounds the joint values to the
/// decimals that the data set states, evaluates the real arm there in extended
/// precision, and adds Gaussian noise. Extended precision makes the positions
/// correctly rounded, so that the same seed gives the same bytes on machines
/// whose sine differs in the last digit.
///
/// Pose k draws from stream k of the seed: it does not depend on the poses
/// before it. `sigmas` of the result hold the noise (1 m where it is zero).
///
/// @throws InputError where no joint values within the limits reach a target.
Dataset Simulate(const SimulationConfig& config);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_SIMULATION_H_
