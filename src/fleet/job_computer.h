#ifndef ALIDADE_SRC_FLEET_JOB_COMPUTER_H_
#define ALIDADE_SRC_FLEET_JOB_COMPUTER_H_

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "src/calibration/identifiability_cache.h"
#include "src/fleet/batch_plan.h"
#include "src/job/run_job.h"
#include "src/report/comparison_page.h"
#include "src/report/report.h"

namespace alidade::internal {

/// Of a job as it is now: where it changes, its result is not what it was.
std::string FingerprintOf(const BatchPlan& plan, const PlannedJob& job,
                          const BatchOptions& options);

/// Of a job that nothing is known of yet.
BatchEntry EntryOf(const PlannedJob& job);

/// Seconds of a clock that a scope took, added to a sum when it ends.
class ScopedTimer {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ScopedTimer(std::atomic<std::int64_t>* nanoseconds)
      : nanoseconds_(nanoseconds) {}
  ~ScopedTimer() { *nanoseconds_ += (Clock::now() - start_).count(); }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  std::atomic<std::int64_t>* const nanoseconds_;
  const Clock::time_point start_ = Clock::now();
};

/// Where the time of all workers goes, in nanoseconds.
struct WorkTimes {
  std::atomic<std::int64_t> reading{0};
  std::atomic<std::int64_t> calibrating{0};
  std::atomic<std::int64_t> writing{0};

  void Add(const WorkTimes& more);
  std::string Format() const;
};

/// What came of a job: its record but for the sizes of its files, which are
/// known when they are written (StagingArea::Stage), and the files of its
/// result, none where there is no usable one.
struct Computed {
  BatchRecord record;
  std::optional<ComparisonItem> item;
  /// What the files are made of while they are written; it stays in its place
  /// when this struct is moved.
  std::unique_ptr<const CalibrationResult> result;
  std::vector<ReportFile> files;
};

/// Loads and calibrates jobs of a plan. Safe to use from several threads.
class JobComputer {
 public:
  /// Each job gets `threads_each`. All that is referred to must outlast it.
  JobComputer(const BatchPlan& plan, const BatchOptions& options,
              int threads_each, WorkTimes* times);

  /// What goes wrong is in the record. @throws OutputConflict.
  Computed Compute(const PlannedJob& job) const;

 private:
  JobConfig Read(const PlannedJob& job, BatchRecord* record) const;
  CalibrationResult Calibrate(const JobConfig& config,
                              const PlannedJob& job) const;
  void Run(const PlannedJob& job, Computed* computed) const;

  const BatchPlan& plan_;
  const BatchOptions& options_;
  WorkTimes& times_;
  const int threads_each_;
  const BatchPlaces places_;
  mutable IdentifiabilityCache cache_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_JOB_COMPUTER_H_
