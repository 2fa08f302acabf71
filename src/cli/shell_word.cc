#include "src/cli/shell_word.h"

#include <string_view>

namespace alidade::internal {

std::string ShellWord(const std::string& path) {
  constexpr std::string_view kSpecial = " \t\n\"'\\$`&|;<>()[]{}*?!#~";
  if (!path.empty() && path.find_first_of(kSpecial) == std::string::npos) {
    return path;
  }
  std::string word = "'";
  for (const char c : path) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace alidade::internal
