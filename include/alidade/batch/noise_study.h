#ifndef ALIDADE_BATCH_NOISE_STUDY_H_
#define ALIDADE_BATCH_NOISE_STUDY_H_

#include "alidade/io/job_config.h"
#include "alidade/results/noise_study.h"

namespace alidade {

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

}  // namespace alidade

#endif  // ALIDADE_BATCH_NOISE_STUDY_H_
