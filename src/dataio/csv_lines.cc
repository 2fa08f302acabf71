#include "src/dataio/csv_lines.h"

#include <algorithm>
#include <functional>

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

template <bool kIsBlank>
const char* SplitBy(std::string_view line, char separator,
                    std::vector<std::string_view>* cells) {
  const auto ends = [separator](char c) {
    return kIsBlank ? IsSpace(c) : c == separator;
  };
  // Tabs that separate are no spaces.
  const auto skip = [separator](const char* at, const char* end) {
    while (at != end && IsSpace(*at) && (kIsBlank || *at != separator)) ++at;
    return at;
  };
  const char* p = line.data();
  const char* const end = p + line.size();
  while (true) {
    const char* first = p = skip(p, end);
    if (kIsBlank && p == end && !cells->empty()) return nullptr;
    const char* last = nullptr;
    if (p != end && *p == '"') {
      last = std::find(p + 1, end, '"');
      // Two of them are one of the text.
      while (end - last > 1 && last[1] == '"') {
        last = std::find(last + 2, end, '"');
      }
      if (last == end) return first;
      p = kIsBlank ? last + 1 : skip(last + 1, end);
      if (p != end && !ends(*p)) return last;
      first = SkipSpaces(first + 1, last);
    } else {
      while (p != end && !ends(*p)) ++p;
      last = p;
    }
    cells->push_back(WithoutSpacesBehind(first, last));
    if (p == end) return nullptr;
    ++p;
  }
}

}  // namespace

std::string_view TakeLine(std::string_view* text) {
  std::string_view line = text->substr(0, text->find('\n'));
  text->remove_prefix(std::min(text->size(), line.size() + 1));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool IsPassedOver(std::string_view line, char separator) {
  const char* const end = line.data() + line.size();
  const char* first = SkipSpaces(line.data(), end);
  if (first == end) return true;
  if (*first == '#' || *first == '%' || *first == '/') {
    return CommentOf(line).data() != nullptr;
  }
  if (*first != separator) return false;
  while (first != end && (*first == separator || IsSpace(*first))) ++first;
  return first == end;
}

std::string_view CommentOf(std::string_view line) {
  const char* const end = line.data() + line.size();
  const char* const first = SkipSpaces(line.data(), end);
  const std::string_view text(first, static_cast<std::size_t>(end - first));
  if (text.empty()) return {};
  if (text.front() == '%') return text.substr(1);
  if (text.substr(0, 2) == "//") return text.substr(2);
  if (text.front() != '#') return {};
  // Spreadsheets write their errors so.
  for (const std::string_view word :
       {"#N/A", "#NV", "#VALUE!", "#WERT!", "#DIV/0!", "#REF!", "#NUM!"}) {
    if (text.substr(0, word.size()) == word) return {};
  }
  return text.substr(1);
}

const char* SplitCells(std::string_view line, char separator,
                       std::vector<std::string_view>* cells) {
  cells->clear();
  return separator == ' ' ? SplitBy<true>(line, separator, cells)
                          : SplitBy<false>(line, separator, cells);
}

void CsvLine::Split(std::vector<std::string_view>* cells) const {
  const char* const fault = SplitCells(text, separator, cells);
  if (fault == nullptr) return;
  // An odd one opens.
  const bool opens = std::count(text.data(), fault + 1, '"') % 2 == 1;
  Fail(opens ? "expected a closing quote (\") in this line"
             : "expected a comma after the closing quote",
       fault);
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
  const bool has_column = cell != nullptr && number > 0 &&
                          !std::less<>()(cell, text.data()) &&
                          !std::less<>()(text.data() + text.size(), cell);
  return {path, number,
          has_column ? static_cast<int>(cell - text.data()) + 1 : 0, column};
}

}  // namespace alidade::internal
