#ifndef ALIDADE_INTERRUPTION_H_
#define ALIDADE_INTERRUPTION_H_

#include <functional>

namespace alidade {

/// Lets whoever waits for long work end it. While it lives, the library calls
/// `check` in the thread that made it, between the parts of its work, some
/// twenty times a second. What `check` throws ends the work: it leaves the call
/// of the library, which may be made again.
///
///   InterruptionScope scope([&] { if (is_cancelled) throw Cancelled(); });
///   CalibrationResult result = Calibrate(arm, data, options);
///
/// Scopes of a thread nest; the innermost counts. Other threads, those that
/// share the work included, do not see it: calibrations of several threads are
/// ended one by one.
class InterruptionScope {
 public:
  explicit InterruptionScope(std::function<void()> check);
  ~InterruptionScope();
  InterruptionScope(const InterruptionScope&) = delete;
  InterruptionScope& operator=(const InterruptionScope&) = delete;

 private:
  friend void CheckInterruption();

  const std::function<void()> check_;
  InterruptionScope* const outer_;
};

/// Calls the check of this thread's scope, if it has one, at most every 50 ms.
/// For long work of one's own; costs some nanoseconds.
void CheckInterruption();

}  // namespace alidade

#endif  // ALIDADE_INTERRUPTION_H_
