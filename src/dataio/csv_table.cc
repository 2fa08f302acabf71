#include "src/dataio/csv_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/parallel.h"
#include "src/common/text.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {
namespace {

class CsvRow final : public TableRow {
 public:
  CsvRow(const std::string& path, const TableHeader& header,
         const CsvDialect& dialect)
      : TableRow(header),
        dialect_(dialect),
        line_{path, {}, 0, dialect.separator} {}

  // False where the filter leaves the row out.
  bool Read(std::string_view text, int line, std::int64_t index) {
    line_.text = text;
    line_.number = line;
    MoveTo(index, line);
    line_.Split(&cells_);
    CheckNumCells();
    if (header().has_conditions() && !header().Keeps(cells_, dialect_)) {
      return false;
    }
    for (const NumberColumn& column : number_columns()) {
      const std::string_view cell = cells_[column.column];
      const double value = ValueOf(cell, column.unit);
      const bool is_allowed =
          !std::isnan(value) ||
          (column.rule != CellRule::kRequired &&
           (IsNotMeasured(cell) || IsStatedMissing(cell, dialect_)));
      if (!is_allowed) FailBadNumber(cell, column);
      SetNumber(column, value);
    }
    return true;
  }

  std::string_view Text(int spec) const override {
    const std::string_view cell = Cell(spec);
    if (cell.find("\"\"") == std::string_view::npos) return cell;
    return text_ = TextOf(cell);
  }

  SourceLocation Location(int spec) const override {
    return line_.Location(Cell(spec).data(), header().NameOf(spec));
  }

 private:
  std::string_view Cell(int spec) const {
    return header().Has(spec) ? cells_[header().ColumnOf(spec)]
                              : std::string_view();
  }

  // NaN where the cell is no number, or one that says that there is none.
  double ValueOf(std::string_view cell, const Unit& unit) const {
    if (!dialect_.missing.empty() && IsStatedMissing(cell, dialect_)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    if (dialect_.has_plain_numbers()) {
      const double value = QuantityOrNan(cell, unit);
      if (!std::isnan(value)) return value;
    }
    return QuantityOrNan(PlainNumber(cell, dialect_).text(), unit);
  }

  [[noreturn]] void FailBadNumber(std::string_view cell,
                                  const NumberColumn& column) const {
    const bool is_otherwise = MarksOf(cell).shape != NumberShape::kNone &&
                              PlainNumber(cell, dialect_).text().empty();
    if (!is_otherwise) FailNumber(column);
    Fail(column.spec,
         "found " + Quote(cell) + " in a file with " +
             (dialect_.decimal == ',' ? "decimal commas" : "decimal points") +
             ": write a decimal " +
             (dialect_.decimal == ',' ? "comma" : "point, not a comma") +
             ", or state `decimal` and `thousands` in the job's `data`");
  }

  // Cells without text beyond the header's say nothing.
  void CheckNumCells() {
    const std::size_t expected = header().columns().size();
    if (cells_.size() == expected) return;
    const auto extra = cells_.begin() + static_cast<std::ptrdiff_t>(
                                            std::min(expected, cells_.size()));
    const bool is_empty =
        std::all_of(extra, cells_.end(),
                    [](std::string_view cell) { return cell.empty(); });
    if (cells_.size() > expected && is_empty) {
      cells_.resize(expected);
      return;
    }
    std::string message = "expected " + std::to_string(expected) +
                          " cells as in the header, found " +
                          std::to_string(cells_.size());
    if (cells_.size() > expected && dialect_.separator == ',') {
      message += ": numbers take a decimal point, not a comma";
    }
    line_.Fail(message + (cells_.size() < expected || dialect_.separator != ','
                              ? "; " + HowToExclude(line_.number)
                              : ""));
  }

  const CsvDialect& dialect_;
  CsvLine line_;
  std::vector<std::string_view> cells_;
  mutable std::string text_;
};

// The first line that begins at `offset` or after it.
std::size_t LineStart(std::string_view text, std::size_t offset) {
  const std::size_t end = text.find('\n', offset - 1);
  return end == std::string_view::npos ? text.size() : end + 1;
}

}  // namespace

CsvTable::CsvTable(MappedFile file, TableContent content,
                   const ReadOptions& options)
    : text_(OpenText(std::move(file))), content_(std::move(content)) {
  const std::string_view text = text_.file.text().substr(text_.begin);
  layout_ = FindCsvLayout(path(), text, content_.dialect);
  ReadHeader(text);
  Cut(text.substr(layout_.rows), options);
  RequireFewRows(path(), num_rows_);
}

void CsvTable::ReadHeader(std::string_view text) {
  CsvLine line{path(), {}, 0, layout_.dialect.separator};
  if (layout_.names.empty()) {
    line.number = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    line.Fail("no header, expected a line of column names: " +
              JoinNames(ExpectedNames(content_.specs)));
  }
  if (layout_.header_line == 0) RequireMapping(text.substr(layout_.rows));
  num_lines_ = layout_.lines_before_rows;
  line.number = layout_.header_line;
  for (int i = 0; i < layout_.header_line; ++i) line.text = TakeLine(&text);
  // Without a header, its first row stands for it in messages.
  if (line.number == 0) line.number = layout_.lines_before_rows + 1;
  header_.emplace(line, layout_.names, content_);
}

// Columns that go by their numbers mean nothing by themselves.
void CsvTable::RequireMapping(std::string_view rows) const {
  const bool is_mapped =
      std::any_of(content_.specs.begin(), content_.specs.end(),
                  [](const ColumnSpec& spec) { return !spec.mapped.empty(); });
  if (is_mapped) return;
  CsvLine line{
      path(), {}, layout_.lines_before_rows, layout_.dialect.separator};
  while (!rows.empty() && IsPassedOver(line.text, line.separator)) {
    line.text = TakeLine(&rows);
    ++line.number;
  }
  std::vector<std::string_view> cells;
  line.Split(&cells);
  line.Fail("found the number " + Quote(cells[0]) +
                ", expected a line of column names first: " +
                JoinNames(ExpectedNames(content_.specs)) +
                "; or `columns` in the job's `data`, which names columns by "
                "their numbers",
            cells[0].data());
}

std::string CsvTable::Notes() const {
  std::vector<std::string> notes = layout_.notes;
  if (!text_.encoding.empty()) {
    notes.insert(notes.begin(), "the text is " + text_.encoding);
  }
  return Join(notes, "; ");
}

void CsvTable::Cut(std::string_view rows, const ReadOptions& options) {
  const auto size = static_cast<std::size_t>(options.chunk_bytes);
  while (!rows.empty()) {
    const std::size_t end = LineStart(rows, std::min(rows.size(), size));
    chunks_.push_back({rows.substr(0, end)});
    rows.remove_prefix(end);
  }
  const char separator = layout_.dialect.separator;
  ParallelFor(options.num_threads, num_chunks(), 1,
              [&](std::int64_t c, std::int64_t) {
                std::string_view rest = chunks_[c].text;
                while (!rest.empty()) {
                  const std::string_view line = TakeLine(&rest);
                  if (!IsPassedOver(line, separator)) ++chunks_[c].num_rows;
                  ++chunks_[c].num_lines;
                }
              });
  for (Chunk& chunk : chunks_) {
    chunk.first_row = num_rows_;
    chunk.lines_before = num_lines_;
    num_rows_ += chunk.num_rows;
    num_lines_ += chunk.num_lines;
  }
}

void CsvTable::VisitChunk(std::int64_t chunk, const Visit& visit) const {
  CsvRow row(path(), *header_, layout_.dialect);
  const LineRanges& excluded = content_.dialect.excluded_lines;
  std::string_view rest = chunks_[chunk].text;
  int line = chunks_[chunk].lines_before;
  for (std::int64_t index = chunks_[chunk].first_row; !rest.empty();) {
    const std::string_view text = TakeLine(&rest);
    ++line;
    if (IsPassedOver(text, layout_.dialect.separator)) continue;
    const std::int64_t number = index++;
    if (excluded.Contains(line)) continue;
    if (row.Read(text, line, number)) visit(row);
  }
}

}  // namespace alidade::internal
