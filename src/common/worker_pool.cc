#include "src/common/worker_pool.h"

#include <chrono>
#include <system_error>
#include <utility>

namespace alidade::internal {
namespace {

// Longer than what a solve does between two passes over its data.
constexpr std::chrono::microseconds kLookFor{100};

// Leaves the core's units to whoever shares them. Not the core itself: a thread
// that yields is left where it is, on the core of the one that it waits for.
void Pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

Worker::Worker() : thread_([this] { Run(); }) {}

Worker::~Worker() {
  Set(State::kEnd);
  thread_.join();
}

void Worker::Start(const std::function<void()>* task) {
  task_ = task;
  Set(State::kGiven);
}

void Worker::Finish() {
  if (!Change(State::kGiven, State::kIdle)) Await(State::kIdle);
}

bool Worker::Change(State from, State to) {
  bool changes = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    changes = state_.compare_exchange_strong(from, to);
  }
  if (changes) changed_.notify_all();
  return changes;
}

void Worker::Run() {
  for (;;) {
    Await(State::kGiven);
    if (state_.load() == State::kEnd) return;
    if (!Change(State::kGiven, State::kRunning)) continue;
    (*task_)();
    Change(State::kRunning, State::kIdle);
  }
}

void Worker::Await(State wanted) {
  const auto is_there = [this, wanted] {
    const State state = state_.load();
    return state == wanted || state == State::kEnd;
  };
  const auto until = std::chrono::steady_clock::now() + kLookFor;
  while (std::chrono::steady_clock::now() < until) {
    if (is_there()) return;
    Pause();
  }
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, is_there);
}

void Worker::Set(State state) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.store(state);
  }
  changed_.notify_all();
}

WorkerPool& WorkerPool::Instance() {
  // Never destroyed: its threads outlive whatever else is at the end.
  static auto* const pool = new WorkerPool;
  return *pool;
}

std::vector<std::unique_ptr<Worker>> WorkerPool::Borrow(std::size_t count) {
  std::vector<std::unique_ptr<Worker>> workers;
  workers.reserve(count);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (workers.size() < count && !idle_.empty()) {
      workers.push_back(std::move(idle_.back()));
      idle_.pop_back();
    }
  }
  // Where the system gives no more threads those that there are do it all.
  try {
    while (workers.size() < count) {
      workers.push_back(std::make_unique<Worker>());
    }
  } catch (const std::system_error&) {
  }
  return workers;
}

void WorkerPool::Return(std::vector<std::unique_ptr<Worker>> workers) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (std::unique_ptr<Worker>& worker : workers) {
    idle_.push_back(std::move(worker));
  }
}

}  // namespace alidade::internal
