#include "src/common/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <utility>

#include "alidade/interruption.h"
#include "src/common/worker_pool.h"

namespace alidade::internal {

void ParallelFor(int num_threads, std::int64_t count, std::int64_t block_size,
                 const std::function<void(std::int64_t, std::int64_t)>& work) {
  const std::int64_t num_blocks = (count + block_size - 1) / block_size;
  std::atomic<std::int64_t> next_block{0};
  std::mutex failure_mutex;
  std::exception_ptr failure;
  const auto take_blocks = [&] {
    for (;;) {
      const std::int64_t block = next_block.fetch_add(1);
      if (block >= num_blocks) return;
      try {
        CheckInterruption();
        work(block * block_size, std::min(count, (block + 1) * block_size));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next_block = num_blocks;
      }
    }
  };
  const auto helpers = std::min<std::int64_t>(num_threads, num_blocks) - 1;
  if (helpers <= 0) {
    take_blocks();
  } else {
    const std::function<void()> task = std::ref(take_blocks);
    WorkerPool& pool = WorkerPool::Instance();
    auto workers = pool.Borrow(static_cast<std::size_t>(helpers));
    for (const auto& worker : workers) worker->Start(&task);
    take_blocks();
    for (const auto& worker : workers) worker->Finish();
    pool.Return(std::move(workers));
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace alidade::internal
