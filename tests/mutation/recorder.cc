// Linked into test programs whose library is woven: writes a line a test to the
// file named by ALIDADE_MUTANTS_REACHED: its name, its milliseconds, whether it
// passed, and the mutants that it came across.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

#include "tests/mutation/mutation.h"

namespace {

using alidade_mutation::reached;

class Recorder : public testing::EmptyTestEventListener {
 public:
  // What the suite's set-up comes across counts for each of its tests.
  void OnTestSuiteStart(const testing::TestSuite&) override {
    std::fill(std::begin(reached), std::end(reached), 0);
    is_first_ = true;
  }

  void OnTestStart(const testing::TestInfo&) override {
    if (is_first_) {
      of_suite_.assign(std::begin(reached), std::end(reached));
    } else {
      std::copy(of_suite_.begin(), of_suite_.end(), std::begin(reached));
    }
    is_first_ = false;
  }

  void OnTestEnd(const testing::TestInfo& test) override {
    if (test.result()->Skipped()) return;
    const char* const path = std::getenv("ALIDADE_MUTANTS_REACHED");
    std::FILE* const file = std::fopen(path, "a");
    if (file == nullptr) return;
    std::fprintf(file, "%s.%s\t%lld\t%d\t", test.test_suite_name(), test.name(),
                 static_cast<long long>(test.result()->elapsed_time()),
                 test.result()->Passed() ? 1 : 0);
    for (int id = 0; id < alidade_mutation::kMostMutants; ++id) {
      if (reached[id] != 0) std::fprintf(file, "%d ", id);
    }
    std::fprintf(file, "\n");
    std::fclose(file);
  }

 private:
  bool is_first_ = false;
  std::vector<unsigned char> of_suite_;
};

const bool is_listening = [] {
  if (std::getenv("ALIDADE_MUTANTS_REACHED") != nullptr) {
    testing::UnitTest::GetInstance()->listeners().Append(new Recorder);
  }
  return true;
}();

}  // namespace
