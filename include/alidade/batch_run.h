#ifndef ALIDADE_BATCH_RUN_H_
#define ALIDADE_BATCH_RUN_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace alidade {

/// Many jobs (docs/batch.md).
struct BatchRunOptions {
  std::string directory;   ///< results go below it
  int num_threads = 1;     ///< jobs at a time
  bool fail_fast = false;  ///< hand out no more jobs once one is not done
  /// Called after each job, by one thread at a time: jobs finished, of how
  /// many, and the name of the last.
  std::function<void(std::int64_t finished, std::int64_t jobs,
                     const std::string& name)>
      on_finished;
};

/// Runs every job of job files and folders that is not done already, and writes
/// results, summary.json, summary.csv and comparison.html. Returns the text of
/// summary.json. What goes wrong with a job is in its entry.
/// @throws InputError where there is no job or the directory cannot be written.
std::string RunBatchOfFiles(const std::vector<std::string>& paths,
                            const BatchRunOptions& options);

}  // namespace alidade

#endif  // ALIDADE_BATCH_RUN_H_
