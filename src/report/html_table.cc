#include "src/report/html_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/report/html_json.h"

namespace alidade {
namespace {

// Of errors and of everything else (joint values, positions).
constexpr int kErrorDigits = 4;
constexpr int kDigits = 7;
// The largest errors of a thinned table are always in it.
constexpr std::size_t kWorstKept = 50;

// The cell at `at`, which is moved behind the comma or line end that closes it.
std::string TakeCell(const std::string& csv, std::size_t* at) {
  std::string cell;
  bool quoted = false;
  for (; *at < csv.size(); ++*at) {
    const char c = csv[*at];
    if (c == '"' && quoted && *at + 1 < csv.size() && csv[*at + 1] == '"') {
      cell += c;
      ++*at;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == ',' || c == '\n')) {
      break;
    } else if (c != '\r') {
      cell += c;
    }
  }
  return cell;
}

bool ParseNumber(const std::string& cell, double* value) {
  const char* end = cell.data() + cell.size();
  const auto result = std::from_chars(cell.data(), end, *value);
  return result.ec == std::errc() && result.ptr == end;
}

std::string CellJson(const std::string& cell, int digits) {
  double value = 0.0;
  if (cell.empty()) return "null";
  return ParseNumber(cell, &value) ? JsonNumber(value, digits) : JsonText(cell);
}

bool StartsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

// Rows that stay where there are too many: every so many, and those of the
// largest errors after calibration.
std::vector<std::size_t> KeptRows(const ResultTable& table,
                                  std::size_t most_rows) {
  std::vector<std::size_t> rows(table.rows.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (rows.size() <= most_rows) return rows;
  const std::size_t every = (rows.size() + most_rows - 1) / most_rows;
  std::set<std::size_t> kept;
  for (std::size_t i = 0; i < rows.size(); i += every) kept.insert(i);
  const int column = table.Column("after_error_mm");
  if (column >= 0) {
    std::vector<double> errors;
    for (const auto& row : table.rows) {
      double error = 0.0;
      errors.push_back(ParseNumber(row[column], &error) ? error : 0.0);
    }
    const std::size_t worst = std::min(kWorstKept, rows.size());
    std::partial_sort(
        rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(worst),
        rows.end(), [&errors](std::size_t a, std::size_t b) {
          return errors[a] != errors[b] ? errors[a] > errors[b] : a < b;
        });
    kept.insert(rows.begin(),
                rows.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  return {kept.begin(), kept.end()};
}

}  // namespace

std::string TableJson(const ResultTable& table, std::size_t most_rows) {
  const std::vector<std::size_t> rows = KeptRows(table, most_rows);
  std::string json =
      "{\"total\":" + std::to_string(table.rows.size()) + ",\"index\":[";
  for (const std::size_t row : rows) {
    if (json.back() != '[') json += ',';
    json += std::to_string(row + 1);
  }
  json += "],\"columns\":{";
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const std::string& name = table.columns[k];
    const bool is_error =
        StartsWith(name, "before_") || StartsWith(name, "after_");
    json += (k > 0 ? "," : "") + JsonText(name) + ":[";
    for (const std::size_t row : rows) {
      if (json.back() != '[') json += ',';
      json += CellJson(table.rows[row][k], is_error ? kErrorDigits : kDigits);
    }
    json += "]";
  }
  return json + "}}";
}

int ResultTable::Column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1
                                : static_cast<int>(found - columns.begin());
}

double ResultTable::Number(std::size_t row, int column) const {
  double value = 0.0;
  return ParseNumber(rows[row][static_cast<std::size_t>(column)], &value)
             ? value
             : std::numeric_limits<double>::quiet_NaN();
}

ResultTable ReadResultTable(const std::string& csv) {
  ResultTable table;
  std::vector<std::string> cells;
  for (std::size_t at = 0; at < csv.size(); ++at) {
    cells.push_back(TakeCell(csv, &at));
    if (at < csv.size() && csv[at] == ',') continue;
    if (table.columns.empty()) {
      table.columns = std::move(cells);
    } else {
      cells.resize(table.columns.size());
      table.rows.push_back(std::move(cells));
    }
    cells.clear();
  }
  return table;
}

}  // namespace alidade
