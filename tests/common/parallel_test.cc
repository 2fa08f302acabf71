#include "src/common/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "src/common/worker_pool.h"

namespace alidade::internal {
namespace {

using Block = std::pair<std::int64_t, std::int64_t>;

// The blocks that were worked on, by their begin.
std::vector<Block> CollectBlocks(int num_threads, std::int64_t count,
                                 std::int64_t block_size) {
  std::mutex mutex;
  std::vector<Block> blocks;
  ParallelFor(num_threads, count, block_size,
              [&](std::int64_t begin, std::int64_t end) {
                const std::lock_guard<std::mutex> lock(mutex);
                blocks.emplace_back(begin, end);
              });
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

struct Case {
  int num_threads;
  std::int64_t count;
  std::int64_t block_size;
};

class ParallelForTest : public ::testing::TestWithParam<Case> {};

TEST_P(ParallelForTest, VisitsEveryIndexOnce) {
  const auto [num_threads, count, block_size] = GetParam();
  std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
  ParallelFor(num_threads, count, block_size,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t i = begin; i < end; ++i) ++visits.at(i);
              });
  for (const std::atomic<int>& visit : visits) ASSERT_EQ(visit, 1);
}

TEST_P(ParallelForTest, BlocksDoNotDependOnThreads) {
  const auto [num_threads, count, block_size] = GetParam();
  std::vector<Block> expected;
  for (std::int64_t begin = 0; begin < count; begin += block_size) {
    expected.emplace_back(begin, std::min(count, begin + block_size));
  }
  EXPECT_EQ(CollectBlocks(num_threads, count, block_size), expected);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, ParallelForTest,
    ::testing::Values(Case{1, 10, 3},     // one thread, ragged last block
                      Case{2, 12, 4},     // even blocks
                      Case{4, 1000, 7},   // many blocks
                      Case{3, 5, 100},    // one block, larger than count
                      Case{16, 30, 10},   // more threads than blocks
                      Case{8, 1, 1},      // a single index
                      Case{4, 257, 256},  // one index over a block
                      Case{4, 0, 8}));    // nothing to do

TEST(ParallelForFixedTest, CountZeroNeverCallsTheWork) {
  for (const int num_threads : {1, 8}) {
    EXPECT_TRUE(CollectBlocks(num_threads, 0, 1).empty());
  }
}

TEST(ParallelForFixedTest, OneThreadIsTheCaller) {
  const std::thread::id caller = std::this_thread::get_id();
  ParallelFor(1, 10, 2, [&](std::int64_t, std::int64_t) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
  });
}

TEST(ParallelForFixedTest, TwoThreadsWorkAtTheSameTime) {
  std::mutex mutex;
  std::condition_variable arrival;
  int num_arrived = 0;
  std::atomic<bool> all_met{true};
  // Each block waits for the other: one thread alone would never get past it.
  ParallelFor(2, 2, 1, [&](std::int64_t, std::int64_t) {
    std::unique_lock<std::mutex> lock(mutex);
    ++num_arrived;
    arrival.notify_all();
    if (!arrival.wait_for(lock, std::chrono::seconds(20),
                          [&] { return num_arrived == 2; })) {
      all_met = false;
    }
  });
  EXPECT_TRUE(all_met);
}

// Blocks that hand out work themselves, from several threads at once, again and
// again: no call gets another one's worker, or waits for ever.
TEST(ParallelForFixedTest, CallsMayBeNestedConcurrentAndMany) {
  constexpr int kCallers = 3;
  constexpr int kCalls = 200;
  std::atomic<int> sum{0};
  std::vector<std::thread> callers;
  for (int k = 0; k < kCallers; ++k) {
    callers.emplace_back([&sum] {
      for (int call = 0; call < kCalls; ++call) {
        ParallelFor(2, 2, 1, [&sum](std::int64_t, std::int64_t) {
          ParallelFor(2, 5, 1, [&sum](std::int64_t begin, std::int64_t) {
            sum += static_cast<int>(begin);
          });
        });
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sum, kCallers * kCalls * 2 * (0 + 1 + 2 + 3 + 4));
}

TEST(WorkerTest, TaskThatWasNotBegunIsTakenBack) {
  std::atomic<int> runs{0};
  const std::function<void()> task = [&runs] { ++runs; };
  for (int k = 0; k < 1000; ++k) {
    Worker worker;
    worker.Start(&task);
    worker.Finish();
    // From here on the task may be gone.
    const int before = runs;
    std::this_thread::yield();
    EXPECT_EQ(runs, before);
  }
}

TEST(WorkerTest, EndsBehindTheTaskThatRuns) {
  std::atomic<bool> runs{false};
  std::atomic<bool> has_ended{false};
  const std::function<void()> task = [&] {
    runs = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    has_ended = true;
  };
  {
    Worker worker;
    worker.Start(&task);
    while (!runs) std::this_thread::yield();
  }
  EXPECT_TRUE(has_ended);
}

TEST(ParallelForFixedTest, RethrowsAnExceptionWithItsType) {
  for (const int num_threads : {1, 2, 8}) {
    try {
      ParallelFor(num_threads, 100, 10, [](std::int64_t begin, std::int64_t) {
        if (begin == 50) throw std::out_of_range("block 50");
      });
      ADD_FAILURE() << "nothing thrown with " << num_threads << " threads";
    } catch (const std::out_of_range& error) {
      EXPECT_STREQ(error.what(), "block 50");
    }
  }
}

TEST(ParallelForFixedTest, OneExceptionOfManyArrives) {
  EXPECT_THROW(ParallelFor(8, 100, 1,
                           [](std::int64_t begin, std::int64_t) {
                             throw std::runtime_error(std::to_string(begin));
                           }),
               std::runtime_error);
}

TEST(ParallelForFixedTest, NoBlockStartsAfterAnException) {
  int num_blocks = 0;
  EXPECT_THROW(ParallelFor(1, 100, 1,
                           [&](std::int64_t begin, std::int64_t) {
                             ++num_blocks;
                             if (begin == 3) throw std::runtime_error("stop");
                           }),
               std::runtime_error);
  EXPECT_EQ(num_blocks, 4);
}

TEST(ParallelForFixedTest, EveryThreadHasStoppedWhenAnExceptionArrives) {
  std::atomic<int> num_running{0};
  try {
    ParallelFor(4, 64, 1, [&](std::int64_t begin, std::int64_t) {
      ++num_running;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      --num_running;
      if (begin == 0) throw std::runtime_error("stop");
    });
    ADD_FAILURE() << "nothing thrown";
  } catch (const std::runtime_error&) {
    EXPECT_EQ(num_running, 0);
  }
}

}  // namespace
}  // namespace alidade::internal
