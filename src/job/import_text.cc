#include "src/job/import_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/error.h"
#include "src/common/mapped_file.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {

ImportText::ImportText(const std::string& path, const StatedDialect& stated,
                       std::vector<RowCondition> exclude)
    : path_(path),
      stated_(stated),
      exclude_(std::move(exclude)),
      text_(OpenText(MappedFile(path))) {
  layout_ = FindCsvLayout(path_, text(), stated_);
  if (names().empty()) throw InputError({path_, 0, 0, ""}, "holds no table");
}

std::vector<std::string> ImportText::Notes() const {
  std::vector<std::string> notes;
  if (!text_.encoding.empty()) notes.push_back("the text is " + text_.encoding);
  notes.insert(notes.end(), layout_.notes.begin(), layout_.notes.end());
  return notes;
}

template <typename Use>
void ImportText::VisitLines(const Use& use) const {
  std::string_view rest = text().substr(layout_.rows);
  int number = layout_.lines_before_rows;
  while (!rest.empty()) {
    const std::string_view line = TakeLine(&rest);
    ++number;
    if (IsPassedOver(line, dialect().separator)) continue;
    if (!stated_.IsExcluded(number)) use(line, number);
  }
}

void ImportText::VisitRows(const Visit& visit) const {
  Cells cells;
  VisitLines([&](std::string_view line, int number) {
    if (SplitCells(line, dialect().separator, &cells) != nullptr) return;
    if (!IsExcluded(cells)) visit(cells, number);
  });
}

// Conditions on columns that are not there are refused where the table is read.
bool ImportText::IsExcluded(const Cells& cells) const {
  return std::any_of(exclude_.begin(), exclude_.end(),
                     [&](const RowCondition& condition) {
                       for (std::size_t i = 0;
                            i < std::min(cells.size(), names().size()); ++i) {
                         if (names()[i] != condition.column &&
                             std::to_string(i + 1) != condition.column) {
                           continue;
                         }
                         return condition.IsMet(cells[i], dialect());
                       }
                       return false;
                     });
}

void ImportText::FailSlipped(const std::string& what,
                             const std::vector<int>& lines, bool are_last,
                             const std::string& file) const {
  std::string excluded = file;
  for (const char c : LinesText(lines)) {
    if (c == ' ') {
      excluded += file;
    } else {
      excluded += c;
    }
  }
  throw InputError(
      {path_, lines.front(), 0, ""},
      what + " in lines " + LinesText(lines) +
          (are_last ? ", the last rows of the table: columns may have slipped, "
                      "some pasted a few rows higher than the others, and then "
                      "all rows are wrong: compare the last ones where the "
                      "table was put together; where these are no "
                      "measurements, --exclude="
                    : "; --exclude=") +
          excluded + " leaves them out");
}

void ImportText::RefuseShortRows(const std::string& file) const {
  std::vector<int> lines;
  int last = 0;
  std::size_t fewest = names().size();
  std::size_t most = 0;
  VisitRows([&](const Cells& cells, int line) {
    last = line;
    if (cells.size() >= names().size()) return;
    lines.push_back(line);
    fewest = std::min(fewest, cells.size());
    most = std::max(most, cells.size());
  });
  if (lines.size() < 2) return;
  FailSlipped("expected " + std::to_string(names().size()) +
                  " cells as in the header, found " + std::to_string(fewest) +
                  (most > fewest ? " to " + std::to_string(most) : ""),
              lines, last - lines.front() < static_cast<int>(lines.size()),
              file);
}

void ImportText::RefuseBadRows(const std::string& file) const {
  RefuseShortRows(file);
  Cells cells;
  VisitLines([&](std::string_view text, int number) {
    const CsvLine line{path_, text, number, dialect().separator};
    line.Split(&cells);
    if (IsExcluded(cells)) return;
    std::size_t width = cells.size();
    while (width > names().size() && cells[width - 1].empty()) --width;
    if (width == names().size()) return;
    line.Fail("expected " + std::to_string(names().size()) +
              " cells as in the header, found " + std::to_string(width) +
              "; --exclude=" + file + std::to_string(number) +
              " leaves the row out");
  });
}

std::vector<int> ImportText::EmptyAtEnd(const std::vector<int>& columns) const {
  std::vector<int> lines;
  VisitRows([&](const Cells& cells, int line) {
    const bool is_empty =
        std::all_of(columns.begin(), columns.end(), [&](int column) {
          const auto i = static_cast<std::size_t>(column) - 1;
          return i >= cells.size() || cells[i].empty();
        });
    if (!is_empty) lines.clear();
    if (is_empty) lines.push_back(line);
  });
  return lines;
}

void ImportText::RefuseEmptyAtEnd(const std::vector<int>& joints) const {
  const std::vector<int> lines = EmptyAtEnd(joints);
  if (lines.size() > 1) FailSlipped("no joint values", lines, true);
}

std::string ImportText::PlainCell(std::string_view cell) const {
  const PlainNumber number(cell, dialect());
  return number.text().empty() ? TextOf(cell) : std::string(number.text());
}

double ImportText::LargestOf(const std::vector<int>& columns,
                             const StatedDialect& stated) const {
  double largest = 0.0;
  VisitRows([&](const Cells& cells, int line) {
    if (stated.IsExcluded(line)) return;
    for (const int column : columns) {
      const auto i = static_cast<std::size_t>(column) - 1;
      if (i >= cells.size() || IsStatedMissing(cells[i], dialect())) continue;
      const double value = NumberOrNan(PlainCell(cells[i]));
      if (std::abs(value) > largest) largest = std::abs(value);
    }
  });
  return largest;
}

std::string LinesText(const std::vector<int>& lines) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < lines.size() && lines[i + 1] == lines[i] + 1) ++i;
    parts.push_back(std::to_string(lines[first]));
    if (i > first) parts.back() += "-" + std::to_string(lines[i]);
  }
  return JoinNames(parts);
}

}  // namespace alidade::internal
