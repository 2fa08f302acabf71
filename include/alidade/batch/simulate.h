#ifndef ALIDADE_BATCH_SIMULATE_H_
#define ALIDADE_BATCH_SIMULATE_H_

#include <string>

#include "alidade/io/job_config.h"
#include "alidade/measurement/dataset.h"

namespace alidade {

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

/// LoadJob of a job whose data may be simulated (`data: {simulate: ...}`).
/// @throws InputError as LoadJob and Simulate.
JobConfig ReadJob(const std::string& path, int num_threads = 1,
                  Team* team = nullptr);

}  // namespace alidade

#endif  // ALIDADE_BATCH_SIMULATE_H_
