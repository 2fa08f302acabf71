#include "alidade/interruption.h"

#include <chrono>
#include <utility>

namespace alidade {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kInterval = std::chrono::milliseconds(50);

thread_local InterruptionScope* innermost = nullptr;
thread_local Clock::time_point next_check;

}  // namespace

InterruptionScope::InterruptionScope(std::function<void()> check)
    : check_(std::move(check)), outer_(innermost) {
  innermost = this;
  next_check = Clock::now() + kInterval;
}

InterruptionScope::~InterruptionScope() { innermost = outer_; }

void CheckInterruption() {
  if (innermost == nullptr || Clock::now() < next_check) return;
  next_check = Clock::now() + kInterval;
  innermost->check_();
}

}  // namespace alidade
