#ifndef ALIDADE_SRC_COMMON_TEXT_TABLE_H_
#define ALIDADE_SRC_COMMON_TEXT_TABLE_H_

#include <string>
#include <vector>

namespace alidade::internal {

/// A table of aligned columns for a terminal. Widths count UTF-8 characters.
class TextTable {
 public:
  enum class Align { kLeft, kRight };
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };

  explicit TextTable(std::vector<Column> columns);
  /// @pre one cell per column.
  void AddRow(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }

  /// Header, a rule, the rows; every line after `indent` spaces, no trailing
  /// white space, a newline at the end.
  std::string ToString(int indent = 0) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Adds a row whose cells are wrapped to `widths` (0 = not wrapped): the lines
/// that do not fit stand in rows below. @pre one width per cell.
void AddWrappedRow(const std::vector<std::string>& cells,
                   const std::vector<int>& widths, TextTable* table);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_TEXT_TABLE_H_
