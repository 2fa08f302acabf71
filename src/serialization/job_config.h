#ifndef ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "alidade/monte_carlo.h"
#include "src/calibration/calibration_task.h"
#include "src/simulation/noise_study.h"

namespace alidade::internal {

/// What a result directory holds: all there is, or for fleets of thousands only
/// what machines read, arm.yaml and result.json.
enum class JobOutputs { kFull, kMinimal };

/// The quantities a `published: figures:` entry may name.
const std::vector<std::string>& PublishedQuantityNames();

/// A calibration job, its files loaded and checked against each other: the
/// calibration's task, and what is done with its result.
struct JobConfig : CalibrationTask {
  std::string path;
  std::string title;
  /// Of the data's files, in the order of reading.
  std::vector<RejectedRow> rejected;
  JobOutputs outputs = JobOutputs::kFull;
  std::optional<PublishedStudy> published;
  /// What `montecarlo` simulates.
  MonteCarloOptions montecarlo;
  /// What `compare` runs besides, with the sigmas of the data set.
  std::optional<NoiseStudyConfig> noise_study;
  /// Every file read for this job, the job file first.
  std::vector<std::string> input_files;
  /// The rank that has read each of them; empty: there is one.
  std::vector<int> readers;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_
