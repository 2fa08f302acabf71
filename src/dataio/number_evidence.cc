#include "src/dataio/number_evidence.h"

#include <algorithm>

#include "alidade/error.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {

void NumberEvidence::Keep(char mark, std::string_view cell, int line,
                          Examples* kept) {
  if (kept->count(mark) == 0) (*kept)[mark] = {std::string(cell), line};
}

void NumberEvidence::Add(std::string_view cell, std::size_t column, int line) {
  const NumberMarks marks = MarksOf(cell);
  switch (marks.shape) {
    case NumberShape::kNone:
      return;
    case NumberShape::kInteger:
      has_integers_.resize(std::max(has_integers_.size(), column + 1));
      has_integers_[column] = true;
      if (column == 0) Count(cell);
      return;
    case NumberShape::kAmbiguous:
      has_long_groups_ |= marks.digits_before > 1;
      has_ambiguous_.resize(std::max(has_ambiguous_.size(), column + 1));
      has_ambiguous_[column] = true;
      return Keep(marks.ambiguous, cell, line, &ambiguous_);
    case NumberShape::kDecimal:
      return Keep(marks.decimal, cell, line, &decimals_);
    case NumberShape::kThousands:
      return Keep(marks.thousands, cell, line, &thousands_);
    case NumberShape::kBoth:
      Keep(marks.decimal, cell, line, &decimals_);
      Keep(marks.thousands, cell, line, &thousands_);
  }
}

// Whether the first column counts the rows.
void NumberEvidence::Count(std::string_view cell) {
  const std::optional<int> number = ParseWhole<int>(cell);
  is_counter_ = is_counter_ && number && (!last_ || *number == *last_ + 1);
  last_ = number;
}

void NumberEvidence::AddRows(std::string_view rows, int lines_before,
                             const StatedDialect& stated,
                             const CsvDialect& dialect) {
  int number = lines_before;
  std::vector<std::string_view> cells;
  while (!rows.empty()) {
    const std::string_view line = TakeLine(&rows);
    ++number;
    if (IsPassedOver(line, dialect.separator) || stated.IsExcluded(number) ||
        SplitCells(line, dialect.separator, &cells) != nullptr) {
      continue;
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!IsStatedMissing(cells[i], dialect)) Add(cells[i], i, number);
    }
  }
}

void NumberEvidence::FailAmbiguous(const std::string& path,
                                   const Example& example) const {
  const char mark = example.cell[example.cell.find_first_of(".,")];
  const std::string text = std::string("\"") + mark + "\"";
  throw InputError(
      {path, example.line, 0, ""},
      "the number " + Quote(example.cell) +
          " has a decimal mark, or one of thousands, and the file does not say "
          "which: expected `decimal: " +
          text + "` or `thousands: " + text + "` in the job's `data`");
}

// All marks stand before three digits. Points are decimal ones then, but where
// a column has integers beside them (three decimals would be in all of its
// cells), or other columns have and all points stand behind one digit, as those
// of thousands do in lengths of a few metres. So are commas where no column has
// integers at all, but for one that counts the rows.
char NumberEvidence::AmbiguousAlone(const std::string& path) const {
  if (ambiguous_.empty()) return '.';
  const auto& [mark, example] = *ambiguous_.begin();
  bool has_others = ambiguous_.size() > 1;
  for (std::size_t i = 0; i < has_integers_.size(); ++i) {
    const bool is_mixed = i < has_ambiguous_.size() && has_ambiguous_[i];
    const bool is_beside =
        (i > 0 || !is_counter_) && (mark == ',' || !has_long_groups_);
    has_others |= has_integers_[i] && (is_mixed || is_beside);
  }
  if (has_others) FailAmbiguous(path, example);
  return mark;
}

char NumberEvidence::DecimalMark(const std::string& path,
                                 const StatedDialect& stated) const {
  if (stated.decimal) return *stated.decimal;
  if (decimals_.size() > 1) {
    const Example& point = decimals_.at('.');
    const Example& comma = decimals_.at(',');
    throw InputError({path, std::max(point.line, comma.line), 0, ""},
                     "found " + Quote(point.cell) + " in line " +
                         std::to_string(point.line) + " and " +
                         Quote(comma.cell) + " in line " +
                         std::to_string(comma.line) +
                         ": expected one decimal mark, or `decimal` in the "
                         "job's `data` where one of them is no number");
  }
  if (!decimals_.empty()) return decimals_.begin()->first;
  const char other_of[] = {'.', ','};
  for (const char mark : other_of) {
    const char thousands = mark == '.' ? ',' : '.';
    const bool is_thousands =
        thousands_.count(thousands) > 0 || stated.thousands == thousands;
    if (is_thousands) return mark;
  }
  return AmbiguousAlone(path);
}

void NumberEvidence::Decide(const std::string& path,
                            const StatedDialect& stated,
                            CsvDialect* dialect) const {
  dialect->decimal = DecimalMark(path, stated);
  if (stated.thousands) {
    dialect->thousands = *stated.thousands;
    return;
  }
  for (const auto& [mark, example] : thousands_) {
    const bool is_twice = dialect->thousands != '\0';
    if (mark == dialect->decimal || is_twice) {
      throw InputError({path, example.line, 0, ""},
                       "found " + Quote(example.cell) +
                           " beside numbers that are written otherwise: "
                           "expected one way in all rows, or `thousands` in "
                           "the job's `data`");
    }
    dialect->thousands = mark;
  }
  for (const auto& [mark, example] : ambiguous_) {
    if (mark == dialect->decimal || mark == dialect->thousands) continue;
    if (stated.decimal) continue;
    FailAmbiguous(path, example);
  }
}

}  // namespace alidade::internal
