#ifndef ALIDADE_SRC_FLEET_SCHEDULER_H_
#define ALIDADE_SRC_FLEET_SCHEDULER_H_

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

namespace alidade::internal {

/// Hands out the numbers 0 to count - 1, each once and in this order, to
/// workers that ask: threads of this process, or those that fetch for others.
/// Safe to use from several threads.
class JobQueue {
 public:
  explicit JobQueue(std::int64_t count) : count_(count) {}

  /// Nothing once all are handed out or the queue is stopped.
  std::optional<std::int64_t> Take();
  /// Hands out no more.
  void Stop();

 private:
  std::mutex mutex_;
  const std::int64_t count_;
  std::int64_t next_ = 0;
  bool is_stopped_ = false;
};

/// So many at a time may hold one. A worker computes while it holds one and
/// waits for the disk without, so that processors do not wait with it.
class Permits {
 public:
  explicit Permits(int count) : count_(count) {}

  /// Held as long as it lives.
  class Held {
   public:
    explicit Held(Permits* permits) : permits_(permits) { permits_->Acquire(); }
    ~Held() { permits_->Release(); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

   private:
    Permits* const permits_;
  };

 private:
  void Acquire();
  void Release();

  std::mutex mutex_;
  std::condition_variable released_;
  int count_;
};

/// From threads that put something in to those that take it out. Safe to use
/// from several threads.
template <typename T>
class BlockingQueue {
 public:
  void Put(T value) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      values_.push_back(std::move(value));
    }
    changed_.notify_one();
  }

  /// Nothing will be put in any more.
  void Close() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
  }

  /// Waits for a value; nothing once it is closed and all are taken.
  std::optional<T> Take() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !values_.empty() || is_closed_; });
    if (values_.empty()) return std::nullopt;
    std::optional<T> value = std::move(values_.front());
    values_.pop_front();
    return value;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> values_;
  bool is_closed_ = false;
};

/// Workers for each thread that computes: one computes, the others wait for the
/// disk, which takes about as long as a small job, and more where it is busy.
constexpr int kWorkersPerThread = 4;

/// Lets `num_workers` threads call work() until it says that nothing is left.
/// An exception of work has stop() called at once and is thrown again here,
/// once every thread has ended.
void RunWorkers(int num_workers, const std::function<void()>& stop,
                const std::function<bool()>& work);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_SCHEDULER_H_
