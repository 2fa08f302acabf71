#include "alidade/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace alidade {

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
        work(block * block_size, std::min(count, (block + 1) * block_size));
      } catch (...) {
        const std::lock_guard<std::mutex> lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next_block = num_blocks;
      }
    }
  };
  const auto helpers = std::min<std::int64_t>(num_threads - 1, num_blocks - 1);
  std::vector<std::thread> threads;
  for (std::int64_t i = 0; i < helpers; ++i) threads.emplace_back(take_blocks);
  take_blocks();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace alidade
