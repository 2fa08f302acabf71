#include "src/fleet/remote_jobs.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "src/common/bytes.h"
#include "src/fleet/scheduler.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {
namespace {

enum class Topic {
  kAsk,      ///< to the root: a job is wanted
  kOutcome,  ///< to the root: RemoteOutcome
  kFailure,  ///< to the root: an error
  kLeave,    ///< to the root: times; the last message
};

// To others; numbers of jobs are above.
constexpr std::int64_t kNoMore = -1;
constexpr std::int64_t kDismissed = -2;

// MPI can only be asked whether a message is there. Soon again while jobs come
// and go, and rarely where each takes long, so that asking takes no part of a
// processor worth the name and no job waits for a part of its length worth it.
class Pause {
 public:
  void Reset() { last_ = Clock::now(); }
  void Wait() const {
    std::this_thread::sleep_for(std::clamp<Clock::duration>(
        (Clock::now() - last_) / 64, kLeast, kMost));
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::microseconds kLeast{300};
  static constexpr std::chrono::milliseconds kMost{10};

  Clock::time_point last_ = Clock::now();
};

// A worker that waits for an answer has its processor to itself.
constexpr std::chrono::microseconds kUntilAnswer{100};

std::string NumberMessage(std::int64_t number) {
  ByteWriter writer;
  writer.Put(number);
  return writer.Take();
}

std::string AskMessage() {
  ByteWriter writer;
  writer.Put(Topic::kAsk);
  return writer.Take();
}

void PutCompared(const ComparedResult& result, ByteWriter* writer) {
  writer->PutText(result.label);
  writer->Put(result.before);
  writer->Put(result.after);
  writer->Put(result.is_validated);
  writer->Put(static_cast<std::int64_t>(result.parameters.size()));
  for (const ComparedParameter& parameter : result.parameters) {
    writer->PutText(parameter.name);
    writer->Put(parameter.dimension);
    writer->Put(parameter.value);
    writer->Put(parameter.deviation);
    writer->Put(parameter.std);
    writer->Put(parameter.is_free);
  }
}

ComparedResult GetCompared(ByteReader* reader) {
  ComparedResult result;
  result.label = reader->GetText();
  result.before = reader->Get<Accuracy>();
  result.after = reader->Get<Accuracy>();
  result.is_validated = reader->Get<bool>();
  result.parameters.resize(
      static_cast<std::size_t>(reader->Get<std::int64_t>()));
  for (ComparedParameter& parameter : result.parameters) {
    parameter.name = reader->GetText();
    parameter.dimension = reader->Get<Dimension>();
    parameter.value = reader->Get<double>();
    parameter.deviation = reader->Get<double>();
    parameter.std = reader->Get<double>();
    parameter.is_free = reader->Get<bool>();
  }
  return result;
}

void PutItem(const ComparisonItem& item, ByteWriter* writer) {
  writer->PutTexts({item.version, item.data, item.link});
  for (const std::int64_t count :
       {item.num_free, item.num_limits, item.num_missed, item.num_warnings}) {
    writer->Put(count);
  }
  writer->Put(static_cast<std::int64_t>(item.runs.size()));
  for (const ComparedRun& run : item.runs) {
    writer->PutText(run.solver);
    writer->Put(run.status);
    writer->Put(run.iterations);
    for (const double value : {run.cost, run.train_mean, run.time_s}) {
      writer->Put(value);
    }
  }
  PutCompared(item.values, writer);
}

ComparisonItem GetItem(ByteReader* reader) {
  ComparisonItem item;
  std::vector<std::string> texts = reader->GetTexts();
  item.version = std::move(texts.at(0));
  item.data = std::move(texts.at(1));
  item.link = std::move(texts.at(2));
  for (std::int64_t* count : {&item.num_free, &item.num_limits,
                              &item.num_missed, &item.num_warnings}) {
    *count = reader->Get<std::int64_t>();
  }
  item.runs.resize(static_cast<std::size_t>(reader->Get<std::int64_t>()));
  for (ComparedRun& run : item.runs) {
    run.solver = reader->GetText();
    run.status = reader->Get<SolverStatus>();
    run.iterations = reader->Get<std::int64_t>();
    for (double* value : {&run.cost, &run.train_mean, &run.time_s}) {
      *value = reader->Get<double>();
    }
  }
  item.values = GetCompared(reader);
  return item;
}

std::string OutcomeMessage(std::int64_t number, const Computed& computed,
                           const std::string& staged) {
  ByteWriter writer;
  writer.Put(Topic::kOutcome);
  writer.Put(number);
  writer.PutText(FormatBatchRecord(computed.record));
  writer.PutText(staged);
  writer.Put(computed.item.has_value());
  if (computed.item) {
    PutItem(*computed.item, &writer);
  }
  return writer.Take();
}

std::string FailureMessage(const std::exception& error) {
  ByteWriter writer;
  writer.Put(Topic::kFailure);
  writer.PutText(DescribeError(error));
  return writer.Take();
}

std::string LeaveMessage(const WorkTimes& times) {
  ByteWriter writer;
  writer.Put(Topic::kLeave);
  for (const std::int64_t part :
       {times.reading.load(), times.calibrating.load(), times.writing.load()}) {
    writer.Put(part);
  }
  return writer.Take();
}

RemoteOutcome ReadOutcome(ByteReader* reader) {
  RemoteOutcome outcome;
  outcome.number = reader->Get<std::int64_t>();
  std::optional<BatchRecord> record = ParseBatchRecord(reader->GetText());
  if (!record) throw std::logic_error("a record of another process is none");
  outcome.record = *std::move(record);
  outcome.staged = reader->GetText();
  if (!reader->Get<bool>()) return outcome;
  outcome.item = GetItem(reader);
  return outcome;
}

// One rank's workers and the thread that speaks for them.
class WorkerGroup {
 public:
  WorkerGroup(Communicator* communicator, const BatchPlan& plan,
              const JobComputer& computer, int num_threads,
              StagingArea* staging, WorkTimes* times)
      : communicator_(communicator),
        plan_(plan),
        computer_(computer),
        num_workers_(num_threads * kWorkersPerThread),
        permits_(num_threads),
        staging_(staging),
        times_(times) {}

  void Run() {
    std::thread workers([this] { RunAll(); });
    Speak();
    workers.join();
    communicator_->Send(0, LeaveMessage(*times_));
    AwaitDismissal();
  }

 private:
  void RunAll() {
    try {
      RunWorkers(
          num_workers_, [] {}, [this] { return Work(); });
    } catch (const std::exception& error) {
      Put(FailureMessage(error));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    are_done_ = true;
    to_say_.notify_one();
  }

  // Asks for a job and does it; false where there are no more.
  bool Work() {
    try {
      std::int64_t number = kNoMore;
      Computed computed;
      {
        const Permits::Held permit(&permits_);
        number = Ask();
        if (number < 0) return false;
        computed = computer_.Compute(plan_.jobs[number]);
        // Before the next one is asked for: it may be the last.
        if (computed.files.empty()) {
          Put(OutcomeMessage(number, computed, ""));
          return true;
        }
      }
      const ScopedTimer timer(&times_->writing);
      const std::string staged =
          staging_->Stage(computed.files, &computed.record.files);
      Put(OutcomeMessage(number, computed, staged));
      return true;
    } catch (const std::exception& error) {
      Put(FailureMessage(error));
      return false;
    }
  }

  std::int64_t Ask() {
    std::unique_lock<std::mutex> lock(mutex_);
    said_.push_back(AskMessage());
    ++num_asked_;
    to_say_.notify_one();
    answered_.wait(lock, [this] { return !answers_.empty(); });
    const std::int64_t answer = answers_.front();
    answers_.pop_front();
    return answer;
  }

  void Put(std::string message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    said_.push_back(std::move(message));
    to_say_.notify_one();
  }

  // Until the workers have ended and all that they said is sent. Nothing comes
  // but answers.
  void Speak() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!are_done_ || !said_.empty()) {
      const auto has_to_say = [this] { return !said_.empty() || are_done_; };
      if (num_asked_ == 0) {
        to_say_.wait(lock, has_to_say);
      } else {
        to_say_.wait_for(lock, kUntilAnswer, has_to_say);
      }
      const std::vector<std::string> going = std::exchange(said_, {});
      lock.unlock();
      for (const std::string& message : going) communicator_->Send(0, message);
      const std::optional<Communicator::Message> answer =
          communicator_->Receive();
      lock.lock();
      if (!answer) continue;
      answers_.push_back(ByteReader(answer->bytes).Get<std::int64_t>());
      --num_asked_;
      answered_.notify_one();
    }
  }

  void AwaitDismissal() {
    const Pause pause;
    while (!communicator_->Receive()) pause.Wait();
  }

  Communicator* const communicator_;
  const BatchPlan& plan_;
  const JobComputer& computer_;
  const int num_workers_;
  Permits permits_;
  StagingArea* const staging_;
  WorkTimes* const times_;

  std::mutex mutex_;
  std::condition_variable to_say_;
  std::condition_variable answered_;
  std::vector<std::string> said_;
  std::deque<std::int64_t> answers_;
  int num_asked_ = 0;
  bool are_done_ = false;
};

}  // namespace

void ServeJobs(Communicator* communicator, const JobDispatcher& dispatcher) {
  int num_present = communicator->size() - 1;
  Pause pause;
  while (num_present > 0) {
    const std::optional<Communicator::Message> message =
        communicator->Receive();
    if (!message) {
      pause.Wait();
      continue;
    }
    pause.Reset();
    ByteReader reader(message->bytes);
    switch (reader.Get<Topic>()) {
      case Topic::kAsk:
        communicator->Send(message->from,
                           NumberMessage(dispatcher.take().value_or(kNoMore)));
        break;
      case Topic::kOutcome:
        try {
          dispatcher.finish(ReadOutcome(&reader));
        } catch (const std::exception& error) {
          dispatcher.fail(DescribeError(error));
        }
        break;
      case Topic::kFailure:
        dispatcher.fail(reader.GetText());
        break;
      case Topic::kLeave: {
        WorkTimes times;
        times.reading = reader.Get<std::int64_t>();
        times.calibrating = reader.Get<std::int64_t>();
        times.writing = reader.Get<std::int64_t>();
        dispatcher.add_times(times);
        --num_present;
        break;
      }
    }
  }
}

void DismissRanks(Communicator* communicator) {
  for (int to = 1; to < communicator->size(); ++to) {
    communicator->Send(to, NumberMessage(kDismissed));
  }
}

void WorkForRoot(Communicator* communicator, const BatchPlan& plan,
                 const JobComputer& computer, int num_threads,
                 StagingArea* staging, WorkTimes* times) {
  WorkerGroup(communicator, plan, computer, num_threads, staging, times).Run();
}

}  // namespace alidade::internal
