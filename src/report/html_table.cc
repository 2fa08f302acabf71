#include "src/report/html_table.h"

#include <string>
#include <vector>

#include "src/common/text.h"
#include "src/report/html_json.h"

namespace alidade::internal {
namespace {

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
