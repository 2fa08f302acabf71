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

  /// Header, a rule, the rows; every line behind `indent` spaces, no trailing
  /// white space, a newline at the end.
  std::string ToString(int indent = 0) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_TEXT_TABLE_H_
