#include "alidade/batch_run.h"

#include "alidade/error.h"
#include "src/fleet/batch.h"
#include "src/serialization/result_json.h"

namespace alidade {

std::string RunBatchOfFiles(const std::vector<std::string>& paths,
                            const BatchRunOptions& options) {
  if (paths.empty()) {
    throw InputError({}, "no job files are named, expected some");
  }
  if (options.directory.empty()) {
    throw InputError({"", 0, 0, "directory"},
                     "is empty, expected where results go");
  }
  internal::BatchOptions batch;
  batch.directory = options.directory;
  batch.num_threads = options.num_threads;
  batch.fail_fast = options.fail_fast;
  if (options.on_finished) {
    batch.on_finished = [&options](const internal::BatchProgress& progress) {
      options.on_finished(progress.num_finished, progress.num_jobs,
                          progress.last == nullptr ? "" : progress.last->name);
    };
  }
  return internal::FormatBatchSummary(
      internal::RunBatch(internal::PlanBatch(paths), batch));
}

}  // namespace alidade
