#include "src/cli/batch_progress.h"

#include <unistd.h>

#include <array>
#include <cstdio>

#include "src/cli/command.h"
#include "src/fleet/batch_csv.h"

namespace alidade::internal {
namespace {

constexpr std::chrono::seconds kBetweenLines{10};
constexpr int kBarWidth = 30;

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::string FormatDuration(double seconds) {
  std::array<char, 40> text{};
  const auto whole = static_cast<long long>(seconds + 0.5);
  if (whole < 60) {
    std::snprintf(text.data(), text.size(), "%lld s", whole);
  } else if (whole < 3600) {
    std::snprintf(text.data(), text.size(), "%lld min %lld s", whole / 60,
                  whole % 60);
  } else {
    std::snprintf(text.data(), text.size(), "%lld h %lld min", whole / 3600,
                  whole / 60 % 60);
  }
  return text.data();
}

}  // namespace

std::string FormatBatchProgress(const BatchProgress& progress,
                                std::int64_t num_not_done, double elapsed_s) {
  const double fraction = static_cast<double>(progress.num_finished) /
                          static_cast<double>(progress.num_jobs);
  std::string text = "[";
  for (int i = 0; i < kBarWidth; ++i)
    text += i < fraction * kBarWidth ? '#' : '.';
  text += "] " + std::to_string(progress.num_finished) + "/" +
          std::to_string(progress.num_jobs) + " jobs";
  if (num_not_done > 0)
    text += ", " + std::to_string(num_not_done) + " not done";
  const auto num_run = progress.num_finished - progress.num_found;
  if (num_run == 0 || !(elapsed_s > 0.0)) return text;
  const double rate = static_cast<double>(num_run) / elapsed_s;
  std::array<char, 40> number{};
  std::snprintf(number.data(), number.size(), ", %.3g a second", rate);
  const auto num_left =
      static_cast<double>(progress.num_jobs - progress.num_finished);
  return text + number.data() + ", " + FormatDuration(num_left / rate) +
         " left";
}

BatchProgressReporter::BatchProgressReporter()
    : is_terminal_(isatty(STDERR_FILENO) == 1) {}

void BatchProgressReporter::Report(const BatchProgress& progress) {
  const BatchEntry& entry = *progress.last;
  if (entry.status != BatchStatus::kDone) {
    ++num_not_done_;
    line_.Clear();
    PrintError(entry.name + ": " + ToString(entry.status) + ": " +
               entry.message);
  }
  const Clock::time_point now = Clock::now();
  const std::string text =
      FormatBatchProgress(progress, num_not_done_, Seconds(now - start_));
  if (is_terminal_) {
    line_.Show(text);
  } else if (now - last_line_ >= kBetweenLines) {
    last_line_ = now;
    std::fprintf(stderr, "%s\n", text.c_str());
  }
}

}  // namespace alidade::internal
