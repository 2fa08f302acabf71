#ifndef ALIDADE_SRC_BATCH_SCHEDULER_H_
#define ALIDADE_SRC_BATCH_SCHEDULER_H_

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>

namespace alidade {

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

/// Lets `num_workers` threads call work() until it says that nothing is left.
/// An exception of work stops the queue and is thrown again here, once every
/// thread has ended.
void RunWorkers(int num_workers, JobQueue* queue,
                const std::function<bool()>& work);

}  // namespace alidade

#endif  // ALIDADE_SRC_BATCH_SCHEDULER_H_
