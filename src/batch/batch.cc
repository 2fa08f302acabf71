#include "alidade/batch/batch.h"

#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <new>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/version.h"
#include "alidade/batch/job.h"
#include "alidade/batch/report_page.h"
#include "alidade/batch/result_directory.h"
#include "alidade/batch/simulate.h"
#include "alidade/io/batch_json.h"
#include "alidade/io/files.h"
#include "alidade/report/batch_csv.h"
#include "alidade/report/format.h"
#include "journal.h"
#include "result_store.h"
#include "scheduler.h"

namespace alidade {
namespace {

// The results of all jobs beside each other, those that came to none with what
// stopped them.
std::string CompareResults(const BatchSummary& summary,
                           const std::string& directory) {
  ComparisonPage page;
  for (const BatchEntry& entry : summary.entries) {
    if (entry.directory.empty()) {
      page.AddFailure(entry.name, entry.message);
    } else {
      AddToComparison(directory + "/" + entry.directory, entry.name,
                      directory + "/comparison.html", &page);
    }
  }
  return page.Render(page.GuessKind());
}

// Workers for each thread that computes: one computes, the others wait for the
// disk, which takes about as long as a small job, and more where it is busy.
constexpr int kWorkersPerThread = 4;

std::string FingerprintOf(const BatchPlan& plan, const PlannedJob& job,
                          const BatchOptions& options) {
  std::string fingerprint = plan.matrices[job.matrix].FingerprintOf(job.number);
  if (options.outputs) {
    fingerprint += *options.outputs == JobOutputs::kFull ? "+full" : "+minimal";
  }
  return fingerprint;
}

BatchEntry EntryOf(const PlannedJob& job) {
  BatchEntry entry;
  entry.name = job.name;
  entry.job_file = job.file;
  return entry;
}

// What job files say of the job is in its fingerprint; what they say of others,
// and comments, do not matter.
std::vector<InputFile> WithoutJobFiles(std::vector<InputFile> inputs,
                                       const JobMatrix& matrix) {
  const std::vector<std::string>& files = matrix.files();
  const auto is_job_file = [&files](const InputFile& input) {
    return std::find(files.begin(), files.end(), input.path) != files.end();
  };
  inputs.erase(std::remove_if(inputs.begin(), inputs.end(), is_job_file),
               inputs.end());
  return inputs;
}

BatchStatus StatusOf(JobStatus status) {
  if (status == JobStatus::kDone) return BatchStatus::kDone;
  return status == JobStatus::kMissedLimits ? BatchStatus::kMissedLimits
                                            : BatchStatus::kFailed;
}

void Describe(const JobOutcome& outcome, BatchEntry* entry) {
  const JobResult& result = outcome.result;
  entry->status = StatusOf(outcome.status);
  entry->message = outcome.message;
  entry->title = result.title;
  entry->arm = result.arm;
  entry->data = result.train.name;
  entry->train_before = result.train.before;
  entry->train_after = result.train.after;
  if (result.heldout) {
    entry->heldout_before = result.heldout->before;
    entry->heldout_after = result.heldout->after;
  }
  entry->num_free = result.identifiability.num_free;
  if (!result.runs.empty()) {
    const SolverSummary& summary = result.runs.front().summary;
    entry->solver_status = ToString(summary.status);
    if (!summary.iterations.empty()) {
      entry->iterations = summary.iterations.back().iteration;
    }
  }
  if (result.estimated_sigma > 0.0) entry->sigma = result.estimated_sigma;
  entry->reduced_chi_square = result.reduced_chi_square;
  entry->num_outliers = static_cast<std::int64_t>(result.outliers.size());
  entry->warnings = result.warnings;
}

// Seconds of a clock that a scope took, added to a sum when it ends.
class Stopwatch {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Stopwatch(std::atomic<std::int64_t>* nanoseconds)
      : nanoseconds_(nanoseconds) {}
  ~Stopwatch() { *nanoseconds_ += (Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  std::atomic<std::int64_t>* const nanoseconds_;
  const Clock::time_point start_ = Clock::now();
};

/// Where the time of all workers goes, in nanoseconds.
struct WorkTimes {
  std::atomic<std::int64_t> reading{0};
  std::atomic<std::int64_t> calibrating{0};
  std::atomic<std::int64_t> writing{0};

  std::string Format() const {
    const auto seconds = [](std::int64_t nanoseconds) {
      return FormatSignificant(1e-9 * static_cast<double>(nanoseconds), 3) +
             " s";
    };
    return "reading " + seconds(reading) + ", calibrating " +
           seconds(calibrating) + ", writing " + seconds(writing);
  }
};

/// What came of a job: its record, and the files of its result, none where
/// there is no usable one.
struct Computed {
  BatchRecord record;
  std::vector<ReportFile> files;
};

bool HasResult(const BatchEntry& entry) {
  return entry.status == BatchStatus::kDone ||
         entry.status == BatchStatus::kMissedLimits;
}

class JobComputer {
 public:
  JobComputer(const BatchPlan& plan, const BatchOptions& options,
              WorkTimes* times)
      : plan_(plan), options_(options), times_(*times) {
    const auto num_jobs = static_cast<std::int64_t>(plan.jobs.size());
    reading_.num_threads = static_cast<int>(std::max<std::int64_t>(
        1, options.num_threads / std::max<std::int64_t>(num_jobs, 1)));
    reading_.simulate = Simulate;
  }

  /// Throws nothing: what goes wrong is in the record.
  Computed Compute(const PlannedJob& job) const {
    Computed computed;
    BatchRecord& record = computed.record;
    record.entry = EntryOf(job);
    record.version = Version();
    try {
      if (job.matrix < 0) {
        record.entry.status = BatchStatus::kBadInput;
        record.entry.message = job.error;
      } else {
        Run(job, &computed);
      }
    } catch (const InputError& error) {
      record.entry.status = BatchStatus::kBadInput;
      record.entry.message = error.what();
    } catch (const std::bad_alloc&) {
      record.entry.status = BatchStatus::kFailed;
      record.entry.message = "out of memory";
    } catch (const std::exception& error) {
      record.entry.status = BatchStatus::kFailed;
      record.entry.message = std::string("internal error: ") + error.what();
    }
    if (!HasResult(record.entry)) computed.files.clear();
    return computed;
  }

 private:
  JobConfig Read(const PlannedJob& job, BatchRecord* record) const {
    const Stopwatch stopwatch(&times_.reading);
    record->fingerprint = FingerprintOf(plan_, job, options_);
    JobConfig config = plan_.matrices[job.matrix].Load(job.number, reading_);
    if (options_.outputs) config.outputs = *options_.outputs;
    return config;
  }

  JobOutcome Calibrate(const JobConfig& config, const PlannedJob& job) const {
    const Stopwatch stopwatch(&times_.calibrating);
    return RunJob(config, "alidade batch " + job.file, reading_.num_threads);
  }

  void Run(const PlannedJob& job, Computed* computed) const {
    BatchRecord& record = computed->record;
    const JobConfig config = Read(job, &record);
    const JobOutcome outcome = Calibrate(config, job);
    const Stopwatch stopwatch(&times_.writing);
    record.inputs =
        WithoutJobFiles(outcome.result.inputs, plan_.matrices[job.matrix]);
    Describe(outcome, &record.entry);
    if (!HasResult(record.entry)) return;
    computed->files = RenderResult(outcome, config.outputs);
    record.entry.directory = job.name;
    for (const ReportFile& file : computed->files) {
      if (file.name != "result.json") continue;
      record.result_sha256 = Sha256(file.content);
    }
  }

  const BatchPlan& plan_;
  const BatchOptions& options_;
  WorkTimes& times_;
  JobReading reading_;
};

class BatchRun {
 public:
  BatchRun(const BatchPlan& plan, const BatchOptions& options)
      : plan_(plan),
        options_(options),
        store_(options.directory),
        computer_(plan, options, &times_),
        permits_(options.num_threads),
        queue_(static_cast<std::int64_t>(plan.jobs.size())) {
    summary_.version = Version();
    for (const PlannedJob& job : plan.jobs) {
      store_.CheckName(job.name);
      summary_.entries.push_back(EntryOf(job));
    }
    progress_.num_jobs = static_cast<std::int64_t>(plan.jobs.size());
  }

  BatchSummary Run() {
    RunWorkers(options_.num_threads * kWorkersPerThread, &queue_,
               [this] { return Work(); });
    store_.WriteSummary("summary.csv", FormatBatchCsv(summary_));
    store_.WriteSummary("summary.json", FormatBatchSummary(summary_));
    store_.WriteSummary("comparison.html",
                        CompareResults(summary_, options_.directory));
    LOG(INFO) << "time of all workers: " << times_.Format();
    return std::move(summary_);
  }

 private:
  // Takes a job and does it; false where none is left.
  bool Work() {
    std::optional<std::int64_t> number;
    std::optional<Computed> computed;
    {
      const Permits::Held permit(&permits_);
      number = queue_.Take();
      if (!number) return false;
      const PlannedJob& job = plan_.jobs[*number];
      if (const BatchRecord* const done = FindDone(job)) {
        StopWhereAsked(done->entry);
        Finish(*number, done->entry, true);
        return true;
      }
      computed = computer_.Compute(job);
      StopWhereAsked(computed->record.entry);
    }
    Write(*computed);
    Finish(*number, std::move(computed->record.entry), false);
    return true;
  }

  // Before the next job is taken.
  void StopWhereAsked(const BatchEntry& entry) {
    if (options_.fail_fast && entry.status != BatchStatus::kDone) queue_.Stop();
  }

  void Write(const Computed& computed) {
    const Stopwatch stopwatch(&times_.writing);
    std::string staged;
    if (!computed.files.empty()) staged = store_.Stage(computed.files);
    store_.Commit(computed.record, staged);
  }

  const BatchRecord* FindDone(const PlannedJob& job) {
    if (job.matrix < 0) return nullptr;
    const auto found = store_.records().find(job.name);
    if (found == store_.records().end()) return nullptr;
    const bool is_current =
        IsCurrent(found->second, options_.directory,
                  FingerprintOf(plan_, job, options_), &hashes_);
    return is_current ? &found->second : nullptr;
  }

  void Finish(std::int64_t number, BatchEntry entry, bool was_found) {
    const std::lock_guard<std::mutex> lock(mutex_);
    // The same file may be named otherwise now.
    entry.job_file = plan_.jobs[number].file;
    summary_.entries[number] = std::move(entry);
    ++progress_.num_finished;
    if (was_found) ++progress_.num_found;
    progress_.last = &summary_.entries[number];
    progress_.last_was_found = was_found;
    if (options_.on_finished) options_.on_finished(progress_);
  }

  const BatchPlan& plan_;
  const BatchOptions& options_;
  WorkTimes times_;
  ResultStore store_;
  JobComputer computer_;
  Permits permits_;
  JobQueue queue_;
  FileHashes hashes_;
  std::mutex mutex_;
  BatchSummary summary_;
  BatchProgress progress_;
};

}  // namespace

std::vector<bool> FindDone(const BatchPlan& plan, const BatchOptions& options) {
  const JournalRecords records =
      ReadJournal(options.directory + "/.batch/journal.jsonl");
  FileHashes hashes;
  std::vector<bool> done;
  for (const PlannedJob& job : plan.jobs) {
    const auto found = records.find(job.name);
    done.push_back(job.matrix >= 0 && found != records.end() &&
                   IsCurrent(found->second, options.directory,
                             FingerprintOf(plan, job, options), &hashes));
  }
  return done;
}

BatchSummary RunBatch(const BatchPlan& plan, const BatchOptions& options) {
  return BatchRun(plan, options).Run();
}

}  // namespace alidade
