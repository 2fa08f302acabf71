#ifndef ALIDADE_SRC_FLEET_BATCH_PLAN_H_
#define ALIDADE_SRC_FLEET_BATCH_PLAN_H_

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "alidade/error.h"
#include "src/calibration/batch_summary.h"
#include "src/serialization/job_config.h"
#include "src/serialization/job_matrix.h"

namespace alidade::internal {

/// One job of a batch, not loaded.
struct PlannedJob {
  std::string name;  ///< also its result's directory, below the batch's
  std::string file;
  int matrix = -1;  ///< of BatchPlan::matrices; -1: the file cannot be read
  std::int64_t number = 0;  ///< in its matrix
  std::string error;        ///< why the file cannot be read
};

/// The jobs of a batch in their order: that of the files as named, of a
/// folder's files by their names, of a file's matrix by its axes.
struct BatchPlan {
  std::vector<JobMatrix> matrices;
  std::vector<PlannedJob> jobs;
};

/// Job files, and all of a folder: those files of the folder itself whose names
/// end in ".yaml" or ".yml" and do not begin with "_" or ".", and whose format
/// is not that of an arm, of deviations or of a simulation. A file that is
/// wrong becomes a job with an error.
/// @throws InputError where a folder has no job, or two jobs have one name.
BatchPlan PlanBatch(const std::vector<std::string>& paths);

/// How far a batch is; handed out by one thread at a time.
struct BatchProgress {
  std::int64_t num_jobs = 0;
  std::int64_t num_finished = 0;  ///< of all jobs, those found done included
  std::int64_t num_found = 0;     ///< done by an earlier run and unchanged
  const BatchEntry* last = nullptr;
  bool last_was_found = false;
};

struct BatchOptions {
  std::string directory;  ///< results go below it
  /// Jobs at a time, of each rank. Where there are fewer jobs, each
  /// gets several threads; its result does not depend on it.
  int num_threads = 1;
  /// Hand out no more jobs once one is not done. Otherwise all are run.
  bool fail_fast = false;
  /// In place of what jobs say.
  std::optional<JobOutputs> outputs;
  std::function<void(const BatchProgress&)> on_finished;
};

/// A job reads what the batch replaces. Unlike other errors of a job, one that
/// ends the batch: what the job reads must stay.
class OutputConflict : public InputError {
 public:
  using InputError::InputError;
};

/// The directories of a batch's results, which are replaced as wholes.
class BatchPlaces {
 public:
  BatchPlaces(const BatchPlan& plan, const std::string& directory);

  /// @throws OutputConflict where the file is in one of them.
  void Refuse(const std::string& input) const;

  /// The same of all that job files name plainly, before any job is read.
  void RefuseArmsAndData(const BatchPlan& plan) const;

 private:
  const std::filesystem::path directory_;
  std::unordered_set<std::string> names_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_BATCH_PLAN_H_
