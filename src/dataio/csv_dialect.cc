#include "src/dataio/csv_dialect.h"

#include <algorithm>
#include <cstddef>

#include "src/common/characters.h"
#include "src/common/numbers.h"

namespace alidade::internal {
namespace {

// How many bytes at the start are a blank that stands between digits: a space,
// or one of Unicode's that does not break.
std::size_t BlankSize(std::string_view text) {
  for (const std::string_view blank :
       {" ", "\xc2\xa0", "\xe2\x80\xaf", "\xe2\x80\x89"}) {
    if (text.substr(0, blank.size()) == blank) return blank.size();
  }
  return 0;
}

// Likewise of a minus sign: Unicode's own is one of typesetting.
std::size_t MinusSize(std::string_view text) {
  for (const std::string_view minus : {"-", "\xe2\x88\x92"}) {
    if (text.substr(0, minus.size()) == minus) return minus.size();
  }
  return 0;
}

// Takes a mark between digits off the text; '\0' where there is none.
char TakeMark(std::string_view* text) {
  const char c = text->front();
  if (c == '.' || c == ',' || c == '\'') {
    text->remove_prefix(1);
    return c;
  }
  constexpr std::string_view kQuote = "\xe2\x80\x99";  // typeset
  if (text->substr(0, kQuote.size()) == kQuote) {
    text->remove_prefix(kQuote.size());
    return '\'';
  }
  const std::size_t blank = BlankSize(*text);
  text->remove_prefix(blank);
  return blank > 0 ? ' ' : '\0';
}

std::size_t TakeDigits(std::string_view* text) {
  std::size_t count = 0;
  while (count < text->size() && IsDigit((*text)[count])) ++count;
  text->remove_prefix(count);
  return count;
}

// Without sign; whether what remains may be an exponent is checked by
// ParseNumber.
std::string_view WithoutSign(std::string_view cell) {
  const std::size_t minus = MinusSize(cell);
  if (minus > 0) return cell.substr(minus);
  if (!cell.empty() && cell.front() == '+') return cell.substr(1);
  return cell;
}

bool IsExponent(std::string_view text) {
  if (text.empty() || (text.front() | 0x20) != 'e') return false;
  text = WithoutSign(text.substr(1));
  return TakeDigits(&text) > 0 && text.empty();
}

// The marks of a cell and the digits between them.
struct Groups {
  std::vector<char> marks;
  std::vector<std::size_t> digits;  // one more than marks
  bool is_number = false;
  bool has_exponent = false;

  bool HasThousands(std::size_t num_marks) const {
    if (digits.front() < 1 || digits.front() > 3) return false;
    return std::all_of(
        digits.begin() + 1,
        digits.begin() + 1 + static_cast<std::ptrdiff_t>(num_marks),
        [](std::size_t count) { return count == 3; });
  }
};

Groups GroupsOf(std::string_view cell) {
  Groups groups;
  std::string_view rest = WithoutSign(cell);
  groups.digits.push_back(TakeDigits(&rest));
  std::size_t total = groups.digits.front();
  while (!rest.empty() && (rest.front() | 0x20) != 'e') {
    const char mark = TakeMark(&rest);
    if (mark == '\0') return groups;
    groups.marks.push_back(mark);
    groups.digits.push_back(TakeDigits(&rest));
    total += groups.digits.back();
  }
  groups.has_exponent = !rest.empty();
  groups.is_number = total > 0 && (rest.empty() || IsExponent(rest));
  return groups;
}

bool IsDecimalMark(char mark) { return mark == '.' || mark == ','; }

NumberMarks MarkAlone(std::string_view cell, const Groups& groups) {
  const char mark = groups.marks.front();
  const bool may_be_thousands = groups.HasThousands(1) &&
                                !groups.has_exponent &&
                                WithoutSign(cell).front() != '0';
  if (!IsDecimalMark(mark)) {
    if (!may_be_thousands) return {};
    return {NumberShape::kThousands, '\0', mark};
  }
  if (may_be_thousands) {
    return {NumberShape::kAmbiguous, '\0', '\0', mark,
            static_cast<int>(groups.digits.front())};
  }
  return {NumberShape::kDecimal, mark};
}

}  // namespace

void LineRanges::Add(int first, int last) {
  // All that touch it become one with it.
  auto begin = std::lower_bound(
      ranges_.begin(), ranges_.end(), first,
      [](const auto& range, int line) { return range.second < line; });
  auto end = begin;
  for (; end != ranges_.end() && end->first <= last; ++end) {
    first = std::min(first, end->first);
    last = std::max(last, end->second);
  }
  begin = ranges_.erase(begin, end);
  ranges_.insert(begin, {first, last});
}

bool LineRanges::Contains(int line) const {
  const auto range = std::lower_bound(
      ranges_.begin(), ranges_.end(), line,
      [](const auto& each, int value) { return each.second < value; });
  return range != ranges_.end() && range->first <= line;
}

NumberMarks MarksOf(std::string_view cell) {
  const Groups groups = GroupsOf(cell);
  if (!groups.is_number) return {};
  const std::vector<char>& marks = groups.marks;
  if (marks.empty()) return {NumberShape::kInteger};
  if (marks.size() == 1) return MarkAlone(cell, groups);
  const char first = marks.front();
  const char last = marks.back();
  const bool is_one_kind =
      std::all_of(marks.begin(), marks.end() - 1,
                  [first](char mark) { return mark == first; });
  if (!is_one_kind) return {};
  if (last == first) {
    if (!groups.HasThousands(marks.size())) return {};
    return {NumberShape::kThousands, '\0', first};
  }
  if (!IsDecimalMark(last) || !groups.HasThousands(marks.size() - 1)) return {};
  return {NumberShape::kBoth, last, first};
}

PlainNumber::PlainNumber(std::string_view cell, const CsvDialect& dialect) {
  if (cell.size() >= buffer_.size() - 1) return;
  const Groups groups = GroupsOf(cell);
  if (!groups.is_number) return;
  std::size_t num_thousands = groups.marks.size();
  if (num_thousands > 0 && groups.marks.back() == dialect.decimal) {
    --num_thousands;
  }
  for (std::size_t i = 0; i < num_thousands; ++i) {
    if (dialect.thousands == '\0' || groups.marks[i] != dialect.thousands) {
      return;
    }
  }
  if (num_thousands > 0 && !groups.HasThousands(num_thousands)) return;
  std::size_t size = 0;
  if (MinusSize(cell) > 0) buffer_[size++] = '-';
  std::string_view rest = WithoutSign(cell);
  for (std::size_t i = 0; i <= groups.marks.size(); ++i) {
    for (std::size_t k = 0; k < groups.digits[i]; ++k) {
      buffer_[size++] = rest[k];
    }
    rest.remove_prefix(groups.digits[i]);
    if (i == groups.marks.size()) break;
    TakeMark(&rest);
    if (i == num_thousands) buffer_[size++] = '.';
  }
  for (const char c : rest) buffer_[size++] = c;
  size_ = size;
}

bool IsNotMeasured(std::string_view cell) {
  if (cell.empty()) return true;
  constexpr std::size_t kLongest = 12;
  if (cell.size() > kLongest) return false;
  // The last ones are what Excel writes, in English and German.
  static constexpr std::array<std::string_view, 28> kWords = {
      "nan",    "-nan",    "+nan",  "nan(ind)", "-nan(ind)", "1.#qnan",
      "1.#ind", "-1.#ind", "na",    "n/a",      "n.a.",      "null",
      "none",   "nil",     "-",     "--",       "---",       "----",
      "*",      "***",     "?",     "#n/a",     "#nv",       "#value!",
      "#wert!", "#div/0!", "#ref!", "#num!"};
  const std::string lower = LowerCase(std::string(cell));
  return std::find(kWords.begin(), kWords.end(), lower) != kWords.end();
}

bool IsStatedMissing(std::string_view cell, const CsvDialect& dialect) {
  for (const std::string& word : dialect.missing) {
    if (cell == word) return true;
    const std::optional<double> number = ParseNumber(word);
    if (!number) continue;
    const PlainNumber plain(cell, dialect);
    if (!plain.text().empty() && ParseNumber(plain.text()) == number) {
      return true;
    }
  }
  return false;
}

const char* SeparatorName(char separator) {
  switch (separator) {
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case '|':
      return "bars (|)";
    case ' ':
      return "blanks";
    default:
      return "commas";
  }
}

}  // namespace alidade::internal
