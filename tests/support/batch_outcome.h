#ifndef ALIDADE_TESTS_SUPPORT_BATCH_OUTCOME_H_
#define ALIDADE_TESTS_SUPPORT_BATCH_OUTCOME_H_

#include <filesystem>
#include <map>
#include <string>

#include "tests/support/process.h"
#include "tests/support/without_times.h"

namespace alidade::internal::testing {

/// Everything below a batch's directory but its own records, times aside.
inline std::map<std::string, std::string> BatchOutcome(const std::string& out) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(out)) {
    const std::string name =
        std::filesystem::relative(entry.path(), out).string();
    if (!entry.is_regular_file() || name.rfind(".batch", 0) == 0) continue;
    if (entry.path().filename() == ".alidade-files") continue;  // has times
    if (name == "comparison.html") {
      files[name] = "";  // times of solves are in it
      continue;
    }
    files[name] = entry.path().filename() == "result.json"
                      ? WithoutTimes(entry.path().string())
                      : ReadWhole(entry.path());
  }
  return files;
}

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_BATCH_OUTCOME_H_
