#include "alidade/interruption.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

struct Cancelled {};

// Calls CheckInterruption all the time, for so long.
void WorkFor(milliseconds duration) {
  const auto end = Clock::now() + duration;
  while (Clock::now() < end) CheckInterruption();
}

TEST(InterruptionTest, WithoutAScopeNothingHappens) {
  EXPECT_NO_THROW(WorkFor(milliseconds(60)));
}

TEST(InterruptionTest, TheCheckIsCalledSomeTwentyTimesASecond) {
  int calls = 0;
  const InterruptionScope scope([&] { ++calls; });
  EXPECT_EQ(calls, 0);
  CheckInterruption();
  EXPECT_EQ(calls, 0);
  const auto begin = Clock::now();
  WorkFor(milliseconds(320));
  const double seconds =
      std::chrono::duration<double>(Clock::now() - begin).count();
  // Not more often, however fast the work; on a busy machine less often.
  EXPECT_LE(calls, 20.0 * seconds + 1.0);
  EXPECT_GE(calls, 2);
}

TEST(InterruptionTest, WhatTheCheckThrowsLeavesTheWork) {
  int calls = 0;
  {
    const InterruptionScope scope([&] {
      ++calls;
      throw Cancelled();
    });
    EXPECT_THROW(WorkFor(milliseconds(5000)), Cancelled);
    // The work may be made again.
    EXPECT_THROW(WorkFor(milliseconds(5000)), Cancelled);
  }
  EXPECT_EQ(calls, 2);
  EXPECT_NO_THROW(WorkFor(milliseconds(120)));
  EXPECT_EQ(calls, 2);
}

TEST(InterruptionTest, TheInnermostScopeCounts) {
  int outer = 0, inner = 0;
  const InterruptionScope outer_scope([&] { ++outer; });
  {
    const InterruptionScope inner_scope([&] { ++inner; });
    WorkFor(milliseconds(120));
    EXPECT_EQ(outer, 0);
    EXPECT_GE(inner, 1);
  }
  const int before = inner;
  WorkFor(milliseconds(120));
  EXPECT_GE(outer, 1);
  EXPECT_EQ(inner, before);
}

TEST(InterruptionTest, AScopeLeftByAnExceptionIsGone) {
  int calls = 0;
  try {
    const InterruptionScope scope([&] { ++calls; });
    throw std::runtime_error("of the work");
  } catch (const std::runtime_error&) {
  }
  WorkFor(milliseconds(120));
  EXPECT_EQ(calls, 0);
}

TEST(InterruptionTest, OtherThreadsDoNotSeeIt) {
  const InterruptionScope scope([] { throw Cancelled(); });
  bool was_interrupted = false;
  std::thread other([&] {
    try {
      WorkFor(milliseconds(120));
    } catch (const Cancelled&) {
      was_interrupted = true;
    }
  });
  other.join();
  EXPECT_FALSE(was_interrupted);
  EXPECT_THROW(WorkFor(milliseconds(5000)), Cancelled);
}

}  // namespace
}  // namespace alidade
