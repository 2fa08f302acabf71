#include "src/dataio/csv_lines.h"

#include <algorithm>

namespace alidade::internal {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t'; }

const char* SkipSpaces(const char* p, const char* end) {
  while (p != end && IsSpace(*p)) ++p;
  return p;
}

std::string_view WithoutSpacesBehind(const char* begin, const char* end) {
  while (end != begin && IsSpace(end[-1])) --end;
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view TakeLine(std::string_view* text) {
  std::string_view line = text->substr(0, text->find('\n'));
  text->remove_prefix(std::min(text->size(), line.size() + 1));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool IsPassedOver(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const first = SkipSpaces(line.data(), end);
  return first == end || *first == '#';
}

void CsvLine::Split(std::vector<std::string_view>* cells) const {
  cells->clear();
  const char* p = text.data();
  const char* const end = p + text.size();
  while (true) {
    const char* first = p = SkipSpaces(p, end);
    const char* last = nullptr;
    if (p != end && *p == '"') {
      last = std::find(p + 1, end, '"');
      // Two of them are one of the text.
      while (end - last > 1 && last[1] == '"') {
        last = std::find(last + 2, end, '"');
      }
      if (last == end) {
        Fail("expected a closing quote (\") in this line", first);
      }
      p = SkipSpaces(last + 1, end);
      if (p != end && *p != ',') {
        Fail("expected a comma after the closing quote", last);
      }
      first = SkipSpaces(first + 1, last);
    } else {
      while (p != end && *p != ',') ++p;
      last = p;
    }
    cells->push_back(WithoutSpacesBehind(first, last));
    if (p == end) return;
    ++p;
  }
}

std::string TextOf(std::string_view cell) {
  std::string text(cell);
  for (std::size_t at = 0; (at = text.find("\"\"", at)) != std::string::npos;) {
    text.erase(at++, 1);
  }
  return text;
}

SourceLocation CsvLine::Location(const char* cell,
                                 const std::string& column) const {
  const bool has_column = cell != nullptr && number > 0;
  return {path, number,
          has_column ? static_cast<int>(cell - text.data()) + 1 : 0, column};
}

}  // namespace alidade::internal
