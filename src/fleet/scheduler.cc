#include "src/fleet/scheduler.h"

#include "src/common/parallel.h"

namespace alidade::internal {

std::optional<std::int64_t> JobQueue::Take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (is_stopped_ || next_ == count_) return std::nullopt;
  return next_++;
}

void JobQueue::Stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  is_stopped_ = true;
}

void Permits::Acquire() {
  std::unique_lock<std::mutex> lock(mutex_);
  released_.wait(lock, [this] { return count_ > 0; });
  --count_;
}

void Permits::Release() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++count_;
  }
  released_.notify_one();
}

void RunWorkers(int num_workers, const std::function<void()>& stop,
                const std::function<bool()>& work) {
  // One block a worker: each stays until nothing is left.
  ParallelFor(num_workers, num_workers, 1, [&](std::int64_t, std::int64_t) {
    try {
      while (work()) {
      }
    } catch (...) {
      stop();
      throw;
    }
  });
}

}  // namespace alidade::internal
