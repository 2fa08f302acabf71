#ifndef ALIDADE_SRC_DATAIO_TABLE_HEADER_H_
#define ALIDADE_SRC_DATAIO_TABLE_HEADER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {

/// What a table may hold, and which of its rows are wanted.
struct TableContent {
  /// Texts that rows must have to be read: column, cell.
  using Filter = std::vector<std::pair<std::string, std::string>>;

  const Arm& arm;
  std::vector<ColumnSpec> specs;  ///< the joints first
  bool ignore_others = false;     ///< columns that are none of `specs`
  Filter where = {};
};

/// The columns of a table, as its header names them. Quantities are asked for
/// by their index in the content's `specs`.
class TableHeader {
 public:
  /// A column of the table.
  struct Column {
    std::string name;
    int spec = -1;  ///< -1 = passed over
    const Unit* unit = nullptr;
  };

  /// The content must outlive the header. @throws InputError where a column of
  /// the table is unknown (unless others are ignored) or repeated, its unit
  /// does not fit, or a required one is missing.
  TableHeader(const CsvLine& line, const TableContent& content);

  const std::vector<ColumnSpec>& specs() const { return content_.specs; }
  /// The columns of the table, in its order.
  const std::vector<Column>& columns() const { return columns_; }
  /// The column that holds a quantity; -1 = none does.
  int ColumnOf(int spec) const { return columns_of_[spec]; }
  bool Has(int spec) const { return columns_of_[spec] >= 0; }
  /// The name of that column; empty where there is none.
  std::string NameOf(int spec) const {
    return Has(spec) ? columns_[columns_of_[spec]].name : "";
  }
  /// Whether the filter keeps a row.
  bool Keeps(const std::vector<std::string_view>& cells) const;

  const std::string& path() const { return path_; }
  /// @throws InputError at the header. `column` is its name.
  [[noreturn]] void Fail(const std::string& message,
                         const std::string& column = "") const;

 private:
  using Cells = std::vector<std::string_view>;

  void ReadFilter();
  void RefuseOtherSeparators(const CsvLine& line, const Cells& cells) const;
  void CheckNumJoints(const Cells& cells) const;
  Column ReadColumn(const CsvLine& line, std::string_view cell) const;
  int FindSpec(const CsvLine& line, std::string_view cell) const;
  [[noreturn]] void FailUnknown(const CsvLine& line,
                                std::string_view cell) const;
  void RequireColumns() const;

  const std::string path_;
  const int line_;
  const TableContent& content_;
  std::vector<Column> columns_;
  std::vector<int> columns_of_;                      // by spec
  std::vector<std::pair<int, std::string>> filter_;  // column, text
};

/// Names that the columns of a table may have, one unit of each; joints come
/// last, where a long list is cut.
std::vector<std::string> ExpectedNames(const std::vector<ColumnSpec>& specs);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_TABLE_HEADER_H_
