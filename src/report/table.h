#ifndef ALIDADE_SRC_REPORT_TABLE_H_
#define ALIDADE_SRC_REPORT_TABLE_H_

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/units.h"
#include "src/common/format.h"
#include "src/common/text_table.h"

namespace alidade::internal {

/// Lengths are shown in mm, angles in degrees.
inline double UnitOf(Dimension dimension) {
  return dimension == Dimension::kLength ? kMillimetre : kDegree;
}

inline std::string InUnit(double value, Dimension dimension, int digits) {
  return FormatSignificant(value / UnitOf(dimension), digits);
}

/// A difference: "+0.1", "-0.1", "0".
inline std::string WithSign(const std::string& text) {
  return text.front() == '-' || text == "0" ? text : "+" + text;
}

inline std::string Millimetres(double metres) {
  return FormatSignificant(metres / kMillimetre, 3);
}

/// A cell: what it shows, and the number that it sorts and copies by.
struct TableCell {
  TableCell(std::string words) : text(std::move(words)) {}  // NOLINT: a text
  TableCell(const char* words) : text(words) {}             // NOLINT
  TableCell(std::string words, double number)
      : text(std::move(words)), value(number) {}

  std::string text;
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string markup;  ///< shown by a page in place of the text
};

/// A number with so many significant digits.
TableCell NumberCell(double value, int digits);
/// With so many decimals.
TableCell FixedCell(double value, int decimals);
TableCell CountCell(std::int64_t count);
/// A length in mm or an angle in degrees.
TableCell QuantityCell(double value, Dimension dimension, int digits);

/// A table of a report, as text and in a page.
class Table {
 public:
  enum class Medium { kBoth, kText, kPage };
  static constexpr std::size_t kAllRows =
      std::numeric_limits<std::size_t>::max();
  struct Column {
    /// A title, with its unit in brackets and what a page says of it after a
    /// bar: "change [mm]|found less nominal". ">" before it: numbers, on the
    /// right; "~": sentences, which need room.
    Column(std::string_view title_and_help);  // NOLINT: they make a column
    Column(const char* title_and_help)        // NOLINT
        : Column(std::string_view(title_and_help)) {}
    Column(const std::string& title_and_help)  // NOLINT
        : Column(std::string_view(title_and_help)) {}

    /// The same, its text wrapped to so many characters.
    Column Wrapped(int characters) const {
      Column column = *this;
      column.width = characters;
      return column;
    }

    std::string title;
    std::string help;
    bool is_number = false;
    bool is_long = false;
    Medium medium = Medium::kBoth;  ///< where it is shown
    int width = 0;                  ///< the text is wrapped to it; 0 = not
  };
  static Column TextOnly(Column column) {
    column.medium = Medium::kText;
    return column;
  }
  static Column PageOnly(Column column) {
    column.medium = Medium::kPage;
    return column;
  }

  /// For a text alone.
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  Table(std::string id, std::string caption, std::vector<Column> columns)
      : id_(std::move(id)),
        caption_(std::move(caption)),
        columns_(std::move(columns)) {}

  /// Rows that follow belong together; a page says so above them.
  void BeginGroup(std::string title) {
    groups_.push_back({std::move(title), rows_.size()});
  }
  /// `look` is the row's class in a page. @pre one cell per column.
  void AddRow(std::vector<TableCell> cells, std::string look = "");
  bool empty() const { return rows_.empty(); }
  std::size_t num_rows() const { return rows_.size(); }

  std::string ToText(std::size_t most_rows = kAllRows) const;
  /// With its caption; nothing where there are no rows.
  std::string ToHtml(std::size_t most_rows = kAllRows) const;

 private:
  struct Row {
    std::vector<TableCell> cells;
    std::string look;
  };
  struct Group {
    std::string title;
    std::size_t first = 0;  ///< of its rows
  };
  // The columns that a page shows.
  std::vector<std::size_t> Shown() const;
  std::string BodyHtml(const std::vector<std::size_t>& shown,
                       std::size_t most_rows) const;

  std::string id_;
  std::string caption_;
  std::vector<Column> columns_;
  std::vector<Row> rows_;
  std::vector<Group> groups_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_TABLE_H_
