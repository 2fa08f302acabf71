#ifndef ALIDADE_TESTS_FUZZ_FUZZ_TARGET_H_
#define ALIDADE_TESTS_FUZZ_FUZZ_TARGET_H_

#include <string>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal::fuzz {

/// One reader, and what must hold of all that it reads.
struct FuzzTarget {
  const char* name;
  /// Reads the input as one of tests/fuzz/files: it is called so in messages,
  /// and paths in it are relative to there.
  const char* file;
  /// @throws InputError where the input is wrong, and nothing else.
  void (*read)(const std::string& input, const std::string& path);
};

const std::vector<FuzzTarget>& FuzzTargets();

/// Reads an input, and checks the message where it is wrong. What does not
/// hold ends the process.
void RunTarget(const FuzzTarget& target, const std::string& input);

/// Ends the process, saying what does not hold, where it does not.
void Require(bool holds, const std::string& what);

/// Requires one line of visible UTF-8, at a place that the input has.
void CheckMessage(const InputError& error, const std::string& input,
                  const std::string& path);

/// read(), of what we have written ourselves: no InputError is right.
template <typename Read>
auto ReadBack(const std::string& written, const Read& read) {
  try {
    return read(written);
  } catch (const InputError& error) {
    Require(false, error.what() +
                       (" in what was read and written again:\n" + written));
    throw;
  }
}

}  // namespace alidade::internal::fuzz

#endif  // ALIDADE_TESTS_FUZZ_FUZZ_TARGET_H_
