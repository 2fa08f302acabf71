#include "src/dataio/csv_lines.h"

#include <algorithm>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::string_view kSpaces = " \t";

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpaces);
  if (first == std::string_view::npos) return text.substr(0, 0);
  return text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

std::string_view Unquote(std::string_view cell) {
  if (cell.empty() || cell.front() != '"') return cell;
  return Trim(cell.substr(1, cell.size() - 2));
}

}  // namespace

std::string_view TakeLine(std::string_view* text) {
  std::string_view line = text->substr(0, text->find('\n'));
  text->remove_prefix(std::min(text->size(), line.size() + 1));
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool IsPassedOver(std::string_view line) {
  const std::size_t first = line.find_first_not_of(kSpaces);
  return first == std::string_view::npos || line[first] == '#';
}

CsvLines::CsvLines(const std::string& path, std::string_view text)
    : path_(path), rest_(text) {
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    rest_.remove_prefix(kByteOrderMark.size());
  }
}

bool CsvLines::Next() {
  while (!rest_.empty()) {
    line_ = TakeLine(&rest_);
    ++line_number_;
    if (!IsPassedOver(line_)) return true;
  }
  return false;
}

void CsvLines::Split(std::vector<std::string_view>* cells) const {
  cells->clear();
  std::string_view rest = line_;
  while (true) {
    const std::size_t end = CellEnd(rest);
    cells->push_back(Unquote(Trim(rest.substr(0, end))));
    if (end >= rest.size()) return;
    rest.remove_prefix(end + 1);
  }
}

void CsvLines::Fail(const std::string& message, const char* cell,
                    const std::string& column) const {
  SourceLocation location;
  location.file = path_;
  location.line = line_number_;
  if (cell != nullptr) {
    location.column = ColumnOf(cell);
  }
  location.key = column;
  throw InputError(location, message);
}

// Where the comma after the first cell is; one in quotes does not count.
std::size_t CsvLines::CellEnd(std::string_view text) const {
  const std::size_t quote = text.find_first_not_of(kSpaces);
  if (quote == std::string_view::npos || text[quote] != '"') {
    return std::min(text.find(','), text.size());
  }
  const std::size_t closing = text.find('"', quote + 1);
  if (closing == std::string_view::npos) {
    Fail("expected a closing quote (\") in this line", text.data() + quote);
  }
  const std::size_t end = std::min(text.find(',', closing), text.size());
  if (!Trim(text.substr(closing + 1, end - closing - 1)).empty()) {
    Fail("expected a comma behind the closing quote", text.data() + closing);
  }
  return end;
}

}  // namespace alidade::internal
