#include "src/report/result_table.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include "src/common/text.h"
#include "src/report/html_json.h"

namespace alidade::internal {
namespace {

// The largest errors of a thinned table are always in it.
constexpr std::size_t kWorstKept = 50;

// Reads a CSV piece by piece and calls visit(row's cells) at the end of each
// line, the header's first. The cells are used again.
template <typename Visit>
class CsvVisitor {
 public:
  explicit CsvVisitor(const Visit& visit) : visit_(visit) {}

  void Take(std::string_view piece) {
    for (const char c : piece) Take(c);
  }
  // Of a last line without an end.
  void Finish() {
    if (count_ > 1 || !cells_.front().empty()) EndLine();
  }

 private:
  void Take(char c) {
    std::string& cell = cells_[count_ - 1];
    if (c == '"') {
      // Two in a row within quotes are one of the text.
      if (!quoted_ && closed_) cell += c;
      closed_ = quoted_;
      quoted_ = !quoted_;
      return;
    }
    closed_ = false;
    if (!quoted_ && c == ',') {
      if (count_ == cells_.size()) cells_.emplace_back();
      cells_[count_++].clear();
    } else if (!quoted_ && c == '\n') {
      EndLine();
    } else if (quoted_ || c != '\r') {
      cell += c;
    }
  }

  void EndLine() {
    cells_.resize(count_);
    visit_(cells_);
    count_ = 1;
    cells_.front().clear();
    quoted_ = false;
    closed_ = false;
  }

  const Visit& visit_;
  std::vector<std::string> cells_ = {""};
  std::size_t count_ = 1;  // cells of this line
  bool quoted_ = false;
  bool closed_ = false;  // the last character ended a quotation
};

template <typename Visit>
void ForEachLine(const TextSource& csv, const Visit& visit) {
  CsvVisitor<Visit> visitor(visit);
  csv([&visitor](std::string_view piece) { visitor.Take(piece); });
  visitor.Finish();
}

// Rows that stay where there are too many: every so many, and those of the
// largest errors.
std::vector<std::size_t> KeptRows(const std::vector<double>& errors,
                                  std::size_t most_rows) {
  std::vector<std::size_t> kept;
  const std::size_t every =
      std::max<std::size_t>(1, (errors.size() + most_rows - 1) / most_rows);
  for (std::size_t i = 0; i < errors.size(); i += every) kept.push_back(i);
  if (every == 1) return kept;
  std::vector<std::size_t> worst(std::min(kWorstKept, errors.size()));
  std::vector<std::size_t> rows(errors.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::partial_sort_copy(rows.begin(), rows.end(), worst.begin(), worst.end(),
                         [&errors](std::size_t a, std::size_t b) {
                           return errors[a] != errors[b] ? errors[a] > errors[b]
                                                         : a < b;
                         });
  kept.insert(kept.end(), worst.begin(), worst.end());
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

// The error of each row that the worst are told by.
std::vector<double> ErrorsOf(const TextSource& csv, ResultTable* table) {
  std::vector<double> errors;
  int column = -1;
  bool is_header = true;
  ForEachLine(csv, [&](const std::vector<std::string>& cells) {
    if (is_header) {
      table->columns = cells;
      column = table->Column("after_error_mm");
      is_header = false;
      return;
    }
    double error = 0.0;
    const bool has_error =
        column >= 0 && static_cast<std::size_t>(column) < cells.size() &&
        ParseCell(cells[static_cast<std::size_t>(column)], &error);
    errors.push_back(has_error ? error : 0.0);
  });
  return errors;
}

// Of errors and of everything else (joint values, positions).
constexpr int kErrorDigits = 4;
constexpr int kDigits = 7;

std::string CellJson(const std::string& cell, int digits) {
  double value = 0.0;
  if (cell.empty()) return "null";
  return ParseCell(cell, &value) ? JsonNumber(value, digits) : JsonText(cell);
}

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

}  // namespace

int ResultTable::Column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1
                                : static_cast<int>(found - columns.begin());
}

double ResultTable::Number(std::size_t row, int column) const {
  double value = 0.0;
  return ParseCell(rows[row][static_cast<std::size_t>(column)], &value)
             ? value
             : std::numeric_limits<double>::quiet_NaN();
}

ResultTable ReadResultTable(const TextSource& csv, std::size_t most_rows) {
  ResultTable table;
  const std::vector<double> errors = ErrorsOf(csv, &table);
  table.total = errors.size();
  table.index = KeptRows(errors, most_rows);
  std::size_t line = 0;  // the header's is 0
  auto next = table.index.begin();
  ForEachLine(csv, [&](const std::vector<std::string>& cells) {
    if (line++ == 0 || next == table.index.end() || *next + 2 != line) return;
    ++next;
    table.rows.push_back(cells);
    table.rows.back().resize(table.columns.size());
  });
  return table;
}

std::string TableJson(const ResultTable& table) {
  std::string json =
      "{\"total\":" + std::to_string(table.total) + ",\"index\":[";
  for (const std::size_t row : table.index) {
    if (json.back() != '[') json += ',';
    json += std::to_string(row + 1);
  }
  json += "],\"columns\":{";
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const std::string& name = table.columns[k];
    const bool is_error =
        StartsWith(name, "before_") || StartsWith(name, "after_");
    json += (k > 0 ? "," : "") + JsonText(name) + ":[";
    for (const std::vector<std::string>& row : table.rows) {
      if (json.back() != '[') json += ',';
      json += CellJson(row[k], is_error ? kErrorDigits : kDigits);
    }
    json += "]";
  }
  return json + "}}";
}

}  // namespace alidade::internal
