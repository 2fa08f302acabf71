#include "src/fleet/batch.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "alidade/communicator.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "alidade/version.h"
#include "src/calibration/batch_summary_fields.h"
#include "src/common/files.h"
#include "src/fleet/batch_plan.h"
#include "src/fleet/job_computer.h"
#include "src/fleet/remote_jobs.h"
#include "src/fleet/result_store.h"
#include "src/fleet/scheduler.h"
#include "src/job/report_page.h"
#include "src/report/comparison_page.h"
#include "src/report/rows.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {

namespace {

// As many as the page shows in full; what it needs of others is read again.
constexpr std::size_t kMostItems = 2000;

// Where there are fewer jobs than threads, each has several.
int ThreadsEach(const BatchPlan& plan, const BatchOptions& options,
                int num_ranks) {
  const auto num_jobs = static_cast<std::int64_t>(plan.jobs.size());
  const std::int64_t jobs_each = (num_jobs + num_ranks - 1) / num_ranks;
  return static_cast<int>(std::max<std::int64_t>(
      1, options.num_threads / std::max<std::int64_t>(jobs_each, 1)));
}

// What an earlier run has recorded of a job that is still the same, or null.
const BatchRecord* CurrentRecord(const BatchPlan& plan, const PlannedJob& job,
                                 const BatchOptions& options,
                                 const JournalRecords& records,
                                 FileHashes* hashes) {
  const auto found = records.find(job.name);
  if (job.matrix < 0 || found == records.end()) return nullptr;
  const bool is_current = IsCurrent(found->second, options.directory,
                                    FingerprintOf(plan, job, options), hashes);
  return is_current ? &found->second : nullptr;
}

// The first error of several threads.
class FirstFailure {
 public:
  void Keep(std::exception_ptr failure) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
  }
  void Rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr failure_;
};

// More ranks than that have their results wait for each other.
constexpr int kMostCommitted = 16;

class BatchRun {
 public:
  BatchRun(const BatchPlan& plan, const BatchOptions& options, int num_ranks)
      : plan_(plan),
        options_(options),
        store_(options.directory),
        computer_(plan, options, ThreadsEach(plan, options, num_ranks),
                  &times_),
        permits_(options.num_threads),
        queue_(static_cast<std::int64_t>(plan.jobs.size())) {
    summary_.version = Version();
    store_.CheckSummaries();
    BatchPlaces(plan, options.directory).RefuseArmsAndData(plan);
    for (const PlannedJob& job : plan.jobs) {
      store_.CheckName(job.name);
      summary_.entries.push_back(EntryOf(job));
    }
    items_.resize(std::min(plan.jobs.size(), kMostItems));
    progress_.num_jobs = static_cast<std::int64_t>(plan.jobs.size());
  }

  BatchSummary Run(Communicator* communicator) {
    if (communicator->size() == 1) {
      RunLocal();
    } else {
      RunWithOthers(communicator);
    }
    const ComparisonPage page = CompareResults();
    const ComparisonKind kind = page.GuessKind();
    if (page.num_results() > 1) summary_.comparison = page.Sentence(kind);
    store_.WriteSummary("summary.csv", FormatBatchCsv(summary_));
    store_.WriteSummary("summary.json", FormatBatchSummary(summary_));
    store_.WriteSummary("comparison.html", page.Render(kind));
    LOG(INFO) << "time of all workers: " << times_.Format();
    return std::move(summary_);
  }

 private:
  void RunLocal() {
    RunWorkers(
        options_.num_threads * kWorkersPerThread, [this] { queue_.Stop(); },
        [this] { return Work(); });
  }

  // This thread speaks with other ranks, and others do what there is to do.
  // Whatever fails, it listens until all ranks have left.
  void RunWithOthers(Communicator* communicator) {
    FirstFailure failure;
    const auto guarded = [this, &failure](const auto& work) {
      try {
        work();
      } catch (...) {
        queue_.Stop();
        failure.Keep(std::current_exception());
      }
    };
    // As many results wait to be committed together as from as many threads.
    const int num_committers =
        kWorkersPerThread * std::min(communicator->size() - 1, kMostCommitted);
    std::vector<std::thread> threads;
    guarded([&] {
      threads.emplace_back([&] { guarded([this] { RunLocal(); }); });
      for (int i = 0; i < num_committers; ++i) {
        threads.emplace_back([&] {
          while (std::optional<RemoteOutcome> outcome = outcomes_.Take()) {
            guarded([&] { Accept(*std::move(outcome)); });
          }
        });
      }
    });
    JobDispatcher dispatcher;
    dispatcher.take = [&] {
      std::optional<std::int64_t> number;
      guarded([&] { number = TakeForOther(); });
      return number;
    };
    dispatcher.finish = [&](RemoteOutcome outcome) {
      StopWhereAsked(outcome.record.entry);
      outcomes_.Put(std::move(outcome));
    };
    dispatcher.fail = [&](const std::string& error) {
      guarded([&] { ThrowDescribed(error); });
    };
    dispatcher.add_times = [this](const WorkTimes& times) {
      times_.Add(times);
    };
    ServeJobs(communicator, dispatcher);
    outcomes_.Close();
    for (std::thread& thread : threads) thread.join();
    failure.Rethrow();
  }

  // The results of all jobs beside each other, those that came to none with
  // what stopped them.
  ComparisonPage CompareResults() const {
    ComparisonPage page;
    for (std::size_t i = 0; i < summary_.entries.size(); ++i) {
      const BatchEntry& entry = summary_.entries[i];
      if (entry.directory.empty()) {
        page.AddFailure(entry.name, entry.message);
      } else if (i < items_.size() && items_[i]) {
        page.Add(*items_[i]);
      } else {
        AddToComparison(options_.directory + "/" + entry.directory, entry.name,
                        options_.directory + "/comparison.html", &page);
      }
    }
    return page;
  }

  // Takes a job and does it; false where none is left.
  bool Work() {
    std::optional<std::int64_t> number;
    std::optional<Computed> computed;
    {
      const Permits::Held permit(&permits_);
      number = queue_.Take();
      if (!number) return false;
      if (FinishIfDone(*number)) return true;
      computed = computer_.Compute(plan_.jobs[*number]);
      StopWhereAsked(computed->record.entry);
    }
    {
      const ScopedTimer timer(&times_.writing);
      std::string staged;
      if (!computed->files.empty()) {
        staged = store_.Stage(computed->files, &computed->record.files);
      }
      store_.Commit(computed->record, staged);
    }
    Keep(*number, std::move(computed->item));
    Finish(*number, std::move(computed->record.entry), false);
    return true;
  }

  // The next job that is not done.
  std::optional<std::int64_t> TakeForOther() {
    for (;;) {
      const std::optional<std::int64_t> number = queue_.Take();
      if (!number || !FinishIfDone(*number)) return number;
    }
  }

  void Accept(RemoteOutcome outcome) {
    {
      const ScopedTimer timer(&times_.writing);
      store_.Commit(outcome.record, outcome.staged);
    }
    Keep(outcome.number, std::move(outcome.item));
    Finish(outcome.number, std::move(outcome.record.entry), false);
  }

  // Before the next job is taken.
  void StopWhereAsked(const BatchEntry& entry) {
    if (options_.fail_fast && entry.status != BatchStatus::kDone) queue_.Stop();
  }

  // True where an earlier run has done the job.
  bool FinishIfDone(std::int64_t number) {
    const BatchRecord* const done = CurrentRecord(
        plan_, plan_.jobs[number], options_, store_.records(), &hashes_);
    if (done == nullptr) return false;
    StopWhereAsked(done->entry);
    Finish(number, done->entry, true);
    return true;
  }

  // Each job has a place of its own.
  void Keep(std::int64_t number, std::optional<ComparisonItem> item) {
    const auto place = static_cast<std::size_t>(number);
    if (place < items_.size()) items_[place] = std::move(item);
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
  BlockingQueue<RemoteOutcome> outcomes_;
  std::mutex mutex_;
  BatchSummary summary_;
  std::vector<std::optional<ComparisonItem>> items_;
  BatchProgress progress_;
};

// A job's number must mean the same to all.
void RequireSamePlan(Communicator* communicator, const BatchPlan& plan) {
  std::string all;
  for (const PlannedJob& job : plan.jobs) all += job.name + "\n" + job.error;
  for (const JobMatrix& matrix : plan.matrices) {
    for (const std::string& file : matrix.files()) all += Sha256OfFile(file);
  }
  const std::vector<std::string> hashes = communicator->Gather(Sha256(all));
  for (const std::string& hash : hashes) {
    if (hash == hashes.front()) continue;
    throw InputError(
        {},
        "the processes see different job files: put them where all "
        "machines see the same");
  }
}

// Tells this batch from an earlier one, of which processes may still be ending.
std::string NewMark() {
  std::random_device device;
  return std::to_string(device()) + std::to_string(device());
}

BatchSummary RunAsRoot(const BatchPlan& plan, const BatchOptions& options,
                       Communicator* communicator) {
  BatchRun run(plan, options, communicator->size());
  communicator->Broadcast(NewMark());
  communicator->Sum(0);  // all see the directory
  try {
    BatchSummary summary = run.Run(communicator);
    DismissRanks(communicator);
    return summary;
  } catch (...) {
    DismissRanks(communicator);
    throw;
  }
}

void RunAsOther(const BatchPlan& plan, const BatchOptions& options,
                Communicator* communicator) {
  const std::string mark = communicator->Broadcast("");
  StagingArea staging(options.directory,
                      mark + "-" + std::to_string(communicator->rank()));
  if (!std::filesystem::exists(staging.path())) {
    throw InputError({staging.path(), 0, 0, ""},
                     "is not there for one of the processes: choose an --out "
                     "that all machines see");
  }
  communicator->Sum(0);
  WorkTimes times;
  const JobComputer computer(
      plan, options, ThreadsEach(plan, options, communicator->size()), &times);
  WorkForRoot(communicator, plan, computer, options.num_threads, &staging,
              &times);
}

}  // namespace

std::vector<bool> FindDone(const BatchPlan& plan, const BatchOptions& options) {
  const JournalRecords records =
      ReadJournal(options.directory + "/.batch/journal.jsonl");
  FileHashes hashes;
  std::vector<bool> done;
  for (const PlannedJob& job : plan.jobs) {
    done.push_back(CurrentRecord(plan, job, options, records, &hashes) !=
                   nullptr);
  }
  return done;
}

BatchSummary RunBatch(const BatchPlan& plan, const BatchOptions& options,
                      Communicator* communicator) {
  if (communicator->size() == 1) {
    return BatchRun(plan, options, 1).Run(communicator);
  }
  RequireSamePlan(communicator, plan);
  if (communicator->is_root()) return RunAsRoot(plan, options, communicator);
  RunAsOther(plan, options, communicator);
  return {};
}

std::string ToString(BatchStatus status) {
  std::string words = WordOf(status);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string FormatBatchCsv(const BatchSummary& summary) {
  std::string text =
      "name,job,arm,data,status,message,"
      "train_rms_before_mm,train_rms_after_mm,train_max_before_mm,"
      "train_max_after_mm,validation_rms_before_mm,validation_rms_after_mm,"
      "validation_max_before_mm,validation_max_after_mm,"
      "free,iterations,sigma_mm,reduced_chi_square,outliers,warnings,"
      "directory\n";
  const auto finite = [](double value) {
    return std::isfinite(value) ? value
                                : std::numeric_limits<double>::quiet_NaN();
  };
  for (const BatchEntry& entry : summary.entries) {
    const auto accuracy = [&](const Accuracy& before, const Accuracy& after) {
      for (const double value :
           {before.rms, after.rms, before.max, after.max}) {
        AppendCsvCells(
            &text, after.n > 0 ? finite(value / kMillimetre) : std::nan(""));
      }
    };
    AppendCsvCells(&text, entry.name, entry.job_file, entry.arm, entry.data,
                   ToString(entry.status), entry.message);
    accuracy(entry.train_before, entry.train_after);
    accuracy(entry.validation_before, entry.validation_after);
    if (entry.train_after.n > 0) {
      AppendCsvCells(&text, entry.num_free, entry.iterations,
                     finite(entry.sigma / kMillimetre),
                     finite(entry.reduced_chi_square), entry.num_outliers,
                     entry.warnings.size());
    } else {
      text += ",,,,,,";
    }
    EndCsvRow(&text, entry.directory);
  }
  return text;
}

}  // namespace alidade::internal
