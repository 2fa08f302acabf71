#include "src/cli/progress.h"

#include <glog/logging.h>
#include <unistd.h>

#include <array>
#include <cstdio>

#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/common/format.h"
#include "src/fleet/batch.h"

namespace alidade::internal {

namespace {

constexpr std::chrono::milliseconds kBetweenLines{100};  // of a terminal

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

namespace {

constexpr std::chrono::seconds kBetweenLoggedLines{10};
constexpr int kBarWidth = 30;

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::string FormatWholeSeconds(double seconds) {
  const std::int64_t whole = std::llround(seconds);
  const auto text = [](std::int64_t count, const char* unit) {
    return std::to_string(count) + unit;
  };
  if (whole < 60) return text(whole, " s");
  if (whole < 3600) return text(whole / 60, " min ") + text(whole % 60, " s");
  return text(whole / 3600, " h ") + text(whole / 60 % 60, " min");
}

}  // namespace

std::string FormatBatchProgress(const BatchProgress& progress,
                                std::int64_t num_not_done, double elapsed_s) {
  const double fraction = static_cast<double>(progress.num_finished) /
                          static_cast<double>(progress.num_jobs);
  std::string text = "[";
  for (int i = 0; i < kBarWidth; ++i) {
    text += i < fraction * kBarWidth ? '#' : '.';
  }
  text += "] " + std::to_string(progress.num_finished) + "/" +
          std::to_string(progress.num_jobs) + " jobs";
  if (num_not_done > 0) {
    text += ", " + std::to_string(num_not_done) + " not done";
  }
  const auto num_run = progress.num_finished - progress.num_found;
  if (num_run == 0 || !(elapsed_s > 0.0)) return text;
  const double rate = static_cast<double>(num_run) / elapsed_s;
  std::array<char, 40> number{};
  std::snprintf(number.data(), number.size(), ", %.3g a second", rate);
  const auto num_left =
      static_cast<double>(progress.num_jobs - progress.num_finished);
  return text + number.data() + ", " + FormatWholeSeconds(num_left / rate) +
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
  } else if (now - last_line_ >= kBetweenLoggedLines) {
    last_line_ = now;
    std::fprintf(stderr, "%s\n", text.c_str());
  }
}

namespace {

std::string Seconds(double seconds) {
  return FormatSignificant(seconds, 3) + " s";
}

}  // namespace

void LogReading(const CalibrationData& data,
                const std::vector<std::string>& input_files,
                std::size_t rejected_rows) {
  LOG(INFO) << "read " << data.training.global_poses() << " poses, "
            << data.training.global_observations() << " measurements"
            << (data.validation
                    ? ", and " +
                          std::to_string(data.validation->global_poses()) +
                          " poses for validation"
                    : "")
            << (rejected_rows == 0
                    ? ""
                    : ", without " + std::to_string(rejected_rows) +
                          " rows that measure nothing");
  for (const std::string& path : input_files) VLOG(1) << "  " << path;
}

void LogIdentifiability(const IdentifiabilityResult& result) {
  LOG(INFO) << "identifiability: " << result.num_free << " of "
            << result.decisions.size()
            << " parameters are free; these poses determine "
            << result.nominal_rank.rank << " of them";
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.reason.empty()) continue;
    VLOG(1) << "  " << decision.name << ": " << decision.reason;
  }
}

void LogJob(const CalibrationResult& result) {
  LogIdentifiability(result.identifiability);
  for (const SolverRun& run : result.runs) {
    LOG(INFO) << "solved: " << run.summary.BriefReport();
    VLOG(1) << run.summary.FullReport();
  }
  LOG(INFO) << "time: identifiability " << Seconds(result.identify_time_s)
            << ", in all " << Seconds(result.total_time_s);
}

void LogPlan(const PlanResult& result) {
  LOG(INFO) << "candidates: " << result.num_candidates << " of "
            << result.num_looked_at << " satisfy the constraints";
  LOG(INFO) << "chosen: " << result.joint_values.cols() << " poses by "
            << result.exchanges << " exchanges in " << result.passes
            << " passes, " << Seconds(result.plan_time_s);
}

}  // namespace alidade::internal
