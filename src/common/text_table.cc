#include "src/common/text_table.h"

#include <glog/logging.h>

#include <algorithm>
#include <utility>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr int kColumnGap = 2;

std::string Spaces(int count) {
  return std::string(static_cast<std::size_t>(std::max(count, 0)), ' ');
}

std::string Pad(const std::string& cell, TextTable::Align align, int width) {
  const std::string padding = Spaces(width - Utf8Length(cell));
  return align == TextTable::Align::kLeft ? cell + padding : padding + cell;
}

std::string WithoutTrailingSpace(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

}  // namespace

TextTable::TextTable(std::vector<Column> columns)
    : columns_(std::move(columns)) {}

void TextTable::AddRow(std::vector<std::string> cells) {
  CHECK_EQ(cells.size(), columns_.size());
  rows_.push_back(std::move(cells));
}

std::string TextTable::ToString(int indent) const {
  std::vector<std::string> titles;
  std::vector<std::string> rules;
  std::vector<int> widths;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    titles.push_back(columns_[i].title);
    int width = Utf8Length(columns_[i].title);
    for (const auto& row : rows_) width = std::max(width, Utf8Length(row[i]));
    widths.push_back(width);
    rules.emplace_back(static_cast<std::size_t>(width), '-');
  }
  std::string text;
  const auto add_line = [&](const std::vector<std::string>& cells) {
    std::string line = Spaces(indent);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) line += Spaces(kColumnGap);
      line += Pad(cells[i], columns_[i].align, widths[i]);
    }
    text += WithoutTrailingSpace(std::move(line)) + "\n";
  };
  add_line(titles);
  add_line(rules);
  for (const auto& row : rows_) add_line(row);
  return text;
}

void AddWrappedRow(const std::vector<std::string>& cells,
                   const std::vector<int>& widths, TextTable* table) {
  std::vector<std::vector<std::string>> columns;
  std::size_t height = 1;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    columns.push_back(widths[i] > 0 ? WrapText(cells[i], widths[i])
                                    : std::vector<std::string>{cells[i]});
    height = std::max(height, columns.back().size());
  }
  for (std::size_t line = 0; line < height; ++line) {
    std::vector<std::string> row;
    for (const auto& column : columns) {
      row.push_back(line < column.size() ? column[line] : "");
    }
    table->AddRow(std::move(row));
  }
}

}  // namespace alidade::internal
