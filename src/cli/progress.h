#ifndef ALIDADE_SRC_CLI_PROGRESS_H_
#define ALIDADE_SRC_CLI_PROGRESS_H_

#include <chrono>
#include <cstdint>
#include <string>

#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"
#include "alidade/plan.h"
#include "alidade/solver.h"
#include "src/fleet/batch.h"

namespace alidade::internal {

/// One line on standard error that says how far long work is, and is gone when
/// the work is done. Nothing at all where standard error is no terminal, so
/// that logs stay clean.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { Clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Replaces the line, ten times a second at most.
  void Show(const std::string& text);
  void Clear();

 private:
  const bool is_terminal_;
  bool is_shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Lets every iteration of a solve show its number and what is left of the
/// error. `progress` outlives the options.
void ShowIterations(std::int64_t num_poses, ProgressLine* progress,
                    SolverOptions* options);

/// "[#####.....] 120/240 jobs, 3 not done, 41 a second, 3 s left". `elapsed_s`:
/// since the batch began; jobs that were found done took none of it.
std::string FormatBatchProgress(const BatchProgress& progress,
                                std::int64_t num_not_done, double elapsed_s);

/// Shows on standard error how far a batch is: a bar on a terminal, a line
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

// What --verbosity=1 writes to standard error, a line a step, and 2 in detail.

/// What a job has read.
void LogReading(const CalibrationData& data,
                const std::vector<std::string>& input_files,
                std::size_t rejected_rows = 0);

/// What the identifiability pass has found.
void LogIdentifiability(const IdentifiabilityResult& result);

/// What a job has done, as far as it got.
void LogJob(const CalibrationResult& result);

/// What a plan has looked at and chosen.
void LogPlan(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_PROGRESS_H_
