#include "src/common/yaml_text.h"

#include <algorithm>

#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/common/text.h"

namespace alidade::internal {

std::string QuotedYaml(const std::string& text) {
  std::string quoted = "'";
  for (const char c : CleanUtf8(OneLine(text))) {
    if (c == '\'') quoted += c;
    quoted += c;
  }
  return quoted + "'";
}

std::string YamlText(const std::string& text) {
  const bool is_plain =
      !text.empty() && text.front() != ' ' && text.back() != ' ' &&
      std::all_of(text.begin(), text.end(), [](char c) {
        const char lower = LowerCase(c);
        return IsDigit(c) || (lower >= 'a' && lower <= 'z') || c == '_' ||
               c == ' ' || c == '.' || c == '/' || c == '(' || c == ')';
      });
  return is_plain ? text : QuotedYaml(text);
}

}  // namespace alidade::internal
