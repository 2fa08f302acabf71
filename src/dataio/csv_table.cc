#include "src/dataio/csv_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/parallel.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

class CsvRow final : public TableRow {
 public:
  CsvRow(const std::string& path, const TableHeader& header)
      : TableRow(header), line_{path, {}, 0} {}

  // False where the filter leaves the row out.
  bool Read(std::string_view text, int line, std::int64_t index) {
    line_.text = text;
    line_.number = line;
    MoveTo(index, line);
    line_.Split(&cells_);
    CheckNumCells();
    if (!header().Keeps(cells_)) return false;
    for (const NumberColumn& column : number_columns()) {
      const std::string_view cell = cells_[column.column];
      const double value = QuantityOrNan(cell, column.unit);
      const bool is_allowed =
          !std::isnan(value) ||
          (column.rule != CellRule::kRequired && IsNotMeasured(cell));
      if (!is_allowed) FailNumber(column);
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

  void CheckNumCells() const {
    const std::size_t expected = header().columns().size();
    if (cells_.size() == expected) return;
    std::string message = "expected " + std::to_string(expected) +
                          " cells as in the header, found " +
                          std::to_string(cells_.size());
    if (cells_.size() > expected) {
      message += ": numbers take a decimal point, not a comma";
    }
    line_.Fail(message);
  }

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

CsvTable::CsvTable(const std::string& path, TableContent content,
                   const ReadOptions& options)
    : file_(path), content_(std::move(content)) {
  RefuseOtherEncodings();
  std::string_view rest = file_.text();
  if (rest.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    rest.remove_prefix(kByteOrderMark.size());
  }
  ReadHeader(&rest);
  Cut(rest, options);
  RequireFewRows(path, num_rows_);
}

void CsvTable::RefuseOtherEncodings() const {
  const std::string_view text = file_.text();
  const std::string_view mark = text.substr(0, 2);
  const CsvLine file{file_.path(), {}, 0};
  if (mark == "\xff\xfe" || mark == "\xfe\xff") {
    file.Fail(
        "the text is UTF-16, expected UTF-8: save the file as \"CSV UTF-8\"");
  }
  if (text.find('\0') != std::string_view::npos) {
    file.Fail("not a text file, expected comma-separated values");
  }
}

void CsvTable::ReadHeader(std::string_view* rest) {
  CsvLine line{file_.path(), {}, 0};
  while (!rest->empty() && IsPassedOver(line.text)) {
    line.text = TakeLine(rest);
    ++line.number;
  }
  if (IsPassedOver(line.text)) {
    line.Fail("no header, expected a line of column names: " +
              JoinNames(ExpectedNames(content_.specs)));
  }
  header_.emplace(line, content_);
  num_lines_ = line.number;
}

void CsvTable::Cut(std::string_view rows, const ReadOptions& options) {
  const auto size = static_cast<std::size_t>(options.chunk_bytes);
  while (!rows.empty()) {
    const std::size_t end = LineStart(rows, std::min(rows.size(), size));
    chunks_.push_back({rows.substr(0, end)});
    rows.remove_prefix(end);
  }
  ParallelFor(options.num_threads, num_chunks(), 1,
              [this](std::int64_t c, std::int64_t) {
                std::string_view rest = chunks_[c].text;
                while (!rest.empty()) {
                  if (!IsPassedOver(TakeLine(&rest))) ++chunks_[c].num_rows;
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
  CsvRow row(file_.path(), *header_);
  std::string_view rest = chunks_[chunk].text;
  int line = chunks_[chunk].lines_before;
  for (std::int64_t index = chunks_[chunk].first_row; !rest.empty();) {
    const std::string_view text = TakeLine(&rest);
    ++line;
    if (IsPassedOver(text)) continue;
    if (row.Read(text, line, index++)) visit(row);
  }
}

}  // namespace alidade::internal
