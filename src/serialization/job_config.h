#ifndef ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/communicator.h"
#include "alidade/dataset.h"
#include "alidade/monte_carlo.h"
#include "src/calibration/calibration_task.h"
#include "src/serialization/config_file.h"
#include "src/serialization/field_records.h"
#include "src/serialization/yaml_reader.h"
#include "src/serialization/yaml_tree.h"
#include "src/simulation/noise_study.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {

/// What a result directory holds: all there is, or for fleets of thousands only
/// what machines read, arm.yaml and result.json.
enum class JobOutputs { kFull, kMinimal };

template <>
inline constexpr std::array kWords<JobOutputs> = {
    std::pair{JobOutputs::kFull, "full"},
    std::pair{JobOutputs::kMinimal, "minimal"},
};

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

/// What every part of a job file needs to be read.
struct JobContext {
  Units units;
  NamedFiles files;
  int num_threads = 1;  ///< to read data sets with
  /// The rank that reads each data set's file.
  std::map<std::string, int> readers = {};
};

/// The keys of one job.
const std::vector<std::string>& JobKeys();

/// What a job file may hold.
std::vector<FieldRecord> JobFields();

/// Reads a job, those that it extends, and every file they name; paths are
/// relative to the file that states them. `execution` is the job's as well;
/// the threads make no difference to what is read.
///
/// Ranks read the same job and consecutive files of its data each: what they
/// get is a part of the data (partition.h). Collective. What needs all data in
/// one place is then refused: other solvers than Ceres, folds.
/// @throws InputError with file, line, column and key; also where the file has
/// a `matrix`, which is many jobs (job_matrix.h).
JobConfig LoadJob(const std::string& path, const Execution& execution = {});
/// The same of a job file's root.
JobConfig ReadJob(const YamlValue& root, const Execution& execution = {});

/// The job that a tree describes, its files loaded. @pre no `matrix` in it.
/// @throws InputError.
JobConfig LoadJobTree(YamlDocument tree, const Execution& execution);

/// The same without `validation`, and without limits of validation poses in
/// `acceptance`: no pose is left out of `data`. For plans, and for studies that
/// hold out their own.
JobConfig LoadWholeJob(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_CONFIG_H_
