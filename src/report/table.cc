#include "src/report/table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/markup.h"

namespace alidade::internal {
namespace {

// Numbers are typeset, names and paths stay as they are.
std::string CellHtml(const TableCell& cell, const Table::Column& column,
                     bool is_first) {
  const bool is_number = std::isfinite(cell.value);
  std::string content = cell.markup;
  if (content.empty()) {
    content = column.is_long                  ? Sentences(cell.text)
              : is_number || column.is_number ? Words(cell.text)
                                              : EscapeXml(cell.text);
  }
  std::string look;
  if (column.is_number) look = column.width > 0 ? "right wrap" : "right";
  if (column.is_long) look = "long";
  return Element(is_first ? "th" : "td",
                 {{"scope", is_first ? "row" : ""},
                  {"class", look},
                  {"data-value", is_number ? ShortestNumber(cell.value) : ""}},
                 content);
}

// "before [mm]" with its unit in a line of its own.
std::string HeaderHtml(const Table::Column& column) {
  const std::size_t unit = column.title.find(" [");
  std::string content = EscapeXml(column.title.substr(0, unit));
  if (unit != std::string::npos) {
    content += Element("span", {{"class", "unit"}},
                       EscapeXml(column.title.substr(unit)));
  }
  return Element("th",
                 {{"scope", "col"},
                  {"class", column.is_number ? "right" : ""},
                  {"title", column.help}},
                 content);
}

}  // namespace

TableCell NumberCell(double value, int digits) {
  return {FormatSignificant(value, digits), value};
}

TableCell FixedCell(double value, int decimals) {
  return {FixedNumber(value, decimals), value};
}

TableCell CountCell(std::int64_t count) {
  return {std::to_string(count), static_cast<double>(count)};
}

TableCell QuantityCell(double value, Dimension dimension, int digits) {
  return NumberCell(value / UnitOf(dimension), digits);
}

Table::Column::Column(std::string_view title_and_help)
    : is_number(title_and_help.substr(0, 1) == ">"),
      is_long(title_and_help.substr(0, 1) == "~") {
  if (is_number || is_long) title_and_help.remove_prefix(1);
  const std::size_t bar = title_and_help.find('|');
  title = title_and_help.substr(0, bar);
  if (bar != std::string_view::npos) help = title_and_help.substr(bar + 1);
}

void Table::AddRow(std::vector<TableCell> cells, std::string look) {
  rows_.push_back({std::move(cells), std::move(look)});
}

std::string Table::ToText(std::size_t most_rows) const {
  std::vector<TextTable::Column> columns;
  std::vector<int> widths;
  for (const Column& column : columns_) {
    if (column.medium == Medium::kPage) continue;
    columns.push_back({column.title, column.is_number
                                         ? TextTable::Align::kRight
                                         : TextTable::Align::kLeft});
    widths.push_back(column.width);
  }
  TextTable table(std::move(columns));
  for (std::size_t i = 0; i < std::min(rows_.size(), most_rows); ++i) {
    std::vector<std::string> cells;
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (columns_[k].medium != Medium::kPage) {
        cells.push_back(rows_[i].cells[k].text);
      }
    }
    AddWrappedRow(cells, widths, &table);
  }
  return table.ToString();
}

// Columns in which no row has anything are left out.
std::vector<std::size_t> Table::Shown() const {
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto says_something = [k](const Row& row) {
      const std::string& text = row.cells[k].text;
      return !text.empty() && text != "-" && text != "–";
    };
    if (columns_[k].medium != Medium::kText &&
        std::any_of(rows_.begin(), rows_.end(), says_something)) {
      shown.push_back(k);
    }
  }
  return shown;
}

std::string Table::BodyHtml(const std::vector<std::size_t>& shown,
                            std::size_t most_rows) const {
  std::string html;
  std::string body = "\n";
  auto group = groups_.begin();
  for (std::size_t i = 0; i < std::min(rows_.size(), most_rows); ++i) {
    if (group != groups_.end() && group->first == i) {
      if (i > 0) html += Element("tbody", {}, body);
      body = "\n" +
             Element("tr", {{"class", "group"}},
                     Element("th",
                             {{"scope", "rowgroup"},
                              {"colspan", std::to_string(shown.size())}},
                             EscapeXml(group->title))) +
             "\n";
      ++group;
    }
    std::string cells;
    for (const std::size_t k : shown) {
      cells += CellHtml(rows_[i].cells[k], columns_[k], cells.empty());
    }
    body += Element("tr", {{"class", rows_[i].look}}, cells) + "\n";
  }
  return html + Element("tbody", {}, body);
}

std::string Table::ToHtml(std::size_t most_rows) const {
  if (rows_.empty()) return "";
  const std::vector<std::size_t> shown = Shown();
  std::string head;
  for (const std::size_t k : shown) head += HeaderHtml(columns_[k]);
  const std::string caption = caption_.empty() ? "" : id_ + "-caption";
  const std::string table =
      Element("table", {{"id", id_}, {"aria-labelledby", caption}},
              Element("thead", {}, Element("tr", {}, head)) +
                  BodyHtml(shown, most_rows));
  constexpr std::size_t kFew = 16;
  return Element(
             "div", {{"class", rows_.size() <= kFew ? "table few" : "table"}},
             Element("div", {{"class", "table-head"}},
                     caption.empty()
                         ? ""
                         : Element("h3", {{"id", caption}}, Words(caption_))) +
                 Element("div",
                         {{"class", "scroll"},
                          {"tabindex", "0"},
                          {"role", caption.empty() ? "" : "region"},
                          {"aria-labelledby", caption}},
                         table)) +
         "\n";
}

}  // namespace alidade::internal
