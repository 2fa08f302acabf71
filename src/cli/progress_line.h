#ifndef ALIDADE_SRC_CLI_PROGRESS_LINE_H_
#define ALIDADE_SRC_CLI_PROGRESS_LINE_H_

#include <chrono>
#include <cstdint>
#include <string>

#include "alidade/solver.h"

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

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_PROGRESS_LINE_H_
