#ifndef ALIDADE_SRC_FLEET_BATCH_H_
#define ALIDADE_SRC_FLEET_BATCH_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "alidade/batch_summary.h"
#include "alidade/communicator.h"
#include "src/calibration/job_config.h"
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

/// The paths in a list: one a line, relative to the list's folder; empty lines
/// and those that begin with '#' are passed over. @throws InputError.
std::vector<std::string> ReadJobList(const std::string& path);

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

/// Which jobs RunBatch would find done and unchanged, one per job of the plan.
/// Writes nothing. @throws InputError where the journal cannot be read.
std::vector<bool> FindDone(const BatchPlan& plan, const BatchOptions& options);

/// Runs every job of the plan that is not done already (docs/batch.md): loads
/// it, calibrates as RunJob, and writes its result directory, as many at a time
/// as there are threads; four for each thread are in memory at most, most of
/// them waiting for the disk. What goes wrong
/// with a job stays with it: its entry has the message.
///
/// An interrupted batch is continued by the same call. What was done then is
/// kept where job, inputs and program are what they were, so that the end is as
/// if there had been no interruption: the same bytes, but for times
/// (`time_s` and others in result.json, report.txt and iterations.csv).
///
/// Writes summary.json, summary.csv and comparison.html at the end.
///
/// Ranks divide the work, each with so many threads, in a directory that all
/// see; to be called by all, within Communicator::RunTogether. The root hands
/// out jobs as ranks become free, keeps the journal, gives results their names
/// and has the summary; other ranks return an empty one. The bytes are those of
/// one process.
/// @throws InputError where the directory cannot be written or another process
/// works in it. What was finished before stays.
BatchSummary RunBatch(const BatchPlan& plan, const BatchOptions& options,
                      Communicator* communicator = SingleProcess());

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_BATCH_H_
