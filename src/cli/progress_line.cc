#include "src/cli/progress_line.h"

#include <unistd.h>

#include <array>
#include <cstdio>

#include "alidade/units.h"

namespace alidade::internal {
namespace {

constexpr std::chrono::milliseconds kBetweenLines{100};

// Back to the first column, and clears what stands there.
constexpr char kClear[] = "\r\x1b[K";

}  // namespace

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::Show(const std::string& text) {
  if (!is_terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (is_shown_ && now - last_ < kBetweenLines) return;
  last_ = now;
  is_shown_ = true;
  // The cursor is left in front: a warning that comes next begins there.
  std::fprintf(stderr, "%s%s\r", kClear, text.c_str());
  std::fflush(stderr);
}

void ProgressLine::Clear() {
  if (!is_shown_) return;
  is_shown_ = false;
  std::fprintf(stderr, "%s", kClear);
  std::fflush(stderr);
}

void ShowIterations(std::int64_t num_poses, ProgressLine* progress,
                    SolverOptions* options) {
  options->on_iteration = [num_poses, progress](const IterationRecord& record) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "%lld poses, iteration %d, cost %.6g, rms error %.4g mm, "
                  "%.1f s",
                  static_cast<long long>(num_poses), record.iteration,
                  record.cost, record.rms_error / kMillimetre, record.time_s);
    progress->Show(text.data());
  };
}

}  // namespace alidade::internal
