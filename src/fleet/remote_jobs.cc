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
#include "src/common/fields.h"
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

// What both ends of a message name once: `Pass` writes to it or reads from it.
class WrittenBytes {
 public:
  static constexpr bool kReads = false;

  explicit WrittenBytes(ByteWriter* writer) : writer_(*writer) {}

  template <typename... Values>
  void operator()(const Values&... values) {
    (Put(values), ...);
  }

 private:
  void Put(const std::string& text) { writer_.PutText(text); }
  template <typename T>
  void Put(const T& value) {
    writer_.Put(value);
  }
  template <typename T>
  void Put(const std::vector<T>& list) {
    writer_.Put(static_cast<std::int64_t>(list.size()));
    for (const T& item : list) Pass(*this, item);
  }

  ByteWriter& writer_;
};

class ReadBytes {
 public:
  static constexpr bool kReads = true;

  explicit ReadBytes(ByteReader* reader) : reader_(*reader) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (Get(&values), ...);
  }

 private:
  void Get(std::string* text) { *text = reader_.GetText(); }
  template <typename T>
  void Get(T* value) {
    *value = reader_.Get<T>();
  }
  template <typename T>
  void Get(std::vector<T>* list) {
    list->resize(static_cast<std::size_t>(reader_.Get<std::int64_t>()));
    for (T& item : *list) Pass(*this, item);
  }

  ByteReader& reader_;
};

template <typename Bytes>
void Pass(Bytes& bytes, Subject<Bytes, ComparedParameter>& parameter) {
  bytes(parameter.name, parameter.dimension, parameter.value,
        parameter.deviation, parameter.std, parameter.is_free);
}

template <typename Bytes>
void Pass(Bytes& bytes, Subject<Bytes, ComparedRun>& run) {
  bytes(run.solver, run.status, run.iterations, run.cost, run.train_mean,
        run.time_s);
}

template <typename Bytes>
void Pass(Bytes& bytes, Subject<Bytes, ComparisonItem>& item) {
  bytes(item.version, item.data, item.link, item.num_free, item.num_limits,
        item.num_missed, item.num_warnings, item.runs, item.values.label,
        item.values.before, item.values.after, item.values.is_validated,
        item.values.parameters);
}

std::string OutcomeMessage(std::int64_t number, const Computed& computed,
                           const std::string& staged) {
  ByteWriter writer;
  writer.Put(Topic::kOutcome);
  writer.Put(number);
  writer.PutText(FormatBatchRecord(computed.record));
  writer.PutText(staged);
  writer.Put(computed.item.has_value());
  WrittenBytes bytes(&writer);
  if (computed.item) Pass(bytes, *computed.item);
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
  ReadBytes bytes(reader);
  Pass(bytes, outcome.item.emplace());
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
