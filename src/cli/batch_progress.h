#ifndef ALIDADE_SRC_CLI_BATCH_PROGRESS_H_
#define ALIDADE_SRC_CLI_BATCH_PROGRESS_H_

#include <chrono>
#include <cstdint>
#include <string>

#include "src/cli/progress_line.h"
#include "src/fleet/batch.h"

namespace alidade::internal {

/// "[#####.....] 120/240 jobs, 3 not done, 41 a second, 3 s left". `elapsed_s`:
/// since the batch began; jobs that were found done took none of it.
std::string FormatBatchProgress(const BatchProgress& progress,
                                std::int64_t num_not_done, double elapsed_s);

/// Tells on standard error how far a batch is: a bar on a terminal, a line
/// every ten seconds elsewhere. What goes wrong with a job is a line at once.
class BatchProgressReporter {
 public:
  BatchProgressReporter();
  void Report(const BatchProgress& progress);
  void End() { line_.Clear(); }

 private:
  using Clock = std::chrono::steady_clock;

  const bool is_terminal_;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_line_ = start_;
  std::int64_t num_not_done_ = 0;
  ProgressLine line_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_BATCH_PROGRESS_H_
