#ifndef ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_
#define ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_

#include "src/calibration/job_config.h"
#include "src/simulation/noise_study_result.h"

namespace alidade::internal {

/// Calibrates the job's poses `trials` times, each with fresh Gaussian noise of
/// the data set's sigmas on the true positions, by
///
///   1. the published procedure: three rules, no priors, pseudo-inverse;
///   2. the rank method with priors, by Ceres: Alidade's default;
///   3. the rank method that freezes what is told badly,
///
/// and compares each result with the true arm at the poses of the data set and
/// over the workspace. Trial k draws from stream k of the seed, whatever the
/// threads. @pre config.noise_study and config.truth.
NoiseStudyResult RunNoiseStudy(const JobConfig& config, int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_
