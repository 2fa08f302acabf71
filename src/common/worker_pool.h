#ifndef ALIDADE_SRC_COMMON_WORKER_POOL_H_
#define ALIDADE_SRC_COMMON_WORKER_POOL_H_

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace alidade::internal {

/// A thread that does one task after the other. A solve hands out work every
/// few hundred microseconds, and making a thread takes as long: the thread
/// stays, and looks for the next task for a moment before it sleeps.
class Worker {
 public:
  Worker();
  /// Waits for the task that runs.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// @pre the worker has no task, and `task` outlives Finish and does not
  /// throw.
  void Start(const std::function<void()>* task);
  /// Waits for the task's end, or takes it back where it was not begun.
  void Finish();

 private:
  enum class State { kIdle, kGiven, kRunning, kEnd };

  void Run();
  // Until state_ is `wanted` or kEnd.
  void Await(State wanted);
  // False where the state is not `from`.
  bool Change(State from, State to);
  void Set(State state);

  const std::function<void()>* task_ = nullptr;
  std::atomic<State> state_{State::kIdle};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

/// Workers that whoever needs some may borrow, as many as are ever wanted at
/// once. They end with the process.
class WorkerPool {
 public:
  static WorkerPool& Instance();

  /// Fewer, or none, where the system gives no more threads.
  std::vector<std::unique_ptr<Worker>> Borrow(std::size_t count);
  void Return(std::vector<std::unique_ptr<Worker>> workers);

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_WORKER_POOL_H_
