#include "tests/fuzz/fuzz_target.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "src/common/utf8.h"

namespace alidade::internal::fuzz {

void Require(bool holds, const std::string& what) {
  if (holds) return;
  std::fwrite(what.data(), 1, what.size(), stderr);  // which may hold zeros
  std::fputc('\n', stderr);
  std::abort();
}

void CheckMessage(const InputError& error, const std::string& input,
                  const std::string& path) {
  const std::string message = error.what();
  Require(OnOneLine(message) == message, "not one visible line: " + message);
  Require(!error.message().empty(), "no message: " + message);
  const SourceLocation& location = error.location();
  Require(location.line >= 0 && location.column >= 0,
          "no place of a file: " + message);
  // Lines of arrays are rows.
  const bool is_of_input = location.file.compare(0, path.size(), path) == 0;
  if (!is_of_input || input.find('\x93') == 0) return;
  const auto lines = std::count_if(input.begin(), input.end(), [](char c) {
    return c == '\n' || c == '\r';
  });
  Require(location.line <= lines + 1, "a line that is not there: " + message);
}

void RunTarget(const FuzzTarget& target, const std::string& input) {
  const std::string path =
      std::string(ALIDADE_SOURCE_DIR) + "/tests/fuzz/files/" + target.file;
  try {
    target.read(input, path);
  } catch (const InputError& error) {
    CheckMessage(error, input, path);
  }
}

}  // namespace alidade::internal::fuzz
