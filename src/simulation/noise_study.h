#ifndef ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_
#define ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_

#include <cstdint>

#include "src/calibration/calibration_task.h"
#include "src/simulation/noise_study_result.h"

namespace alidade::internal {

/// Many calibrations of the same poses with fresh noise, where the real arm is
/// known: how a method fares that is not helped by exact data.
struct NoiseStudyConfig {
  int trials = 1000;
  int workspace_poses = 2000;  ///< drawn within the limits
  std::uint64_t seed = 1;
};

/// Calibrates the job's poses `trials` times, each with fresh Gaussian noise of
/// the data set's sigmas on the true positions, by
///
///   1. the published procedure: three rules, no priors, pseudo-inverse;
///   2. the rank method with priors, by Ceres: Alidade's default;
///   3. the rank method that freezes what is weakly identifiable,
///
/// and compares each result with the true arm at the poses of the data set and
/// over the workspace. Trial k draws from stream k of the seed, whatever the
/// threads. @pre config.noise_study and config.options.true_values.
NoiseStudyResult RunNoiseStudy(const CalibrationTask& task,
                               const NoiseStudyConfig& config);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_NOISE_STUDY_H_
