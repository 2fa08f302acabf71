#ifndef ALIDADE_SRC_DATAIO_TABLE_HEADER_H_
#define ALIDADE_SRC_DATAIO_TABLE_HEADER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_dialect.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/row_condition.h"

namespace alidade::internal {

/// What a table may hold, and which of its rows are wanted.
struct TableContent {
  /// Texts that rows must have to be read: column, cell.
  using Filter = std::vector<std::pair<std::string, std::string>>;

  const Arm& arm;
  std::vector<ColumnSpec> specs;  ///< the joints first
  bool ignore_others = false;     ///< columns that are none of `specs`
  Filter where = {};
  std::vector<RowCondition> exclude = {};  ///< of rows that are left out
  StatedDialect dialect = {};              ///< of texts
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
  /// The same with the names of the columns, which `line` may say otherwise.
  /// Its number is 0 where there is no header.
  TableHeader(const CsvLine& line, const std::vector<std::string>& names,
              const TableContent& content);

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
  /// Whether a row is left out by conditions.
  bool has_conditions() const { return !filter_.empty() || !exclude_.empty(); }
  bool Keeps(const std::vector<std::string_view>& cells,
             const CsvDialect& dialect) const;
  /// "X, Y, Z are in mm": what headers do not say and the job's units do.
  std::string DescribeDefaultUnits() const;

  const std::string& path() const { return path_; }
  /// @throws InputError at the header. `column` is its name.
  [[noreturn]] void Fail(const std::string& message,
                         const std::string& column = "") const;

 private:
  using Cells = std::vector<std::string_view>;

  void Read(const CsvLine& line, const Cells& cells);
  void ReadFilter();
  int FindFilterColumn(const std::string& name, const char* use) const;
  void RefuseOtherSeparators(const CsvLine& line, const Cells& cells) const;
  void CheckNumJoints(const Cells& cells) const;
  Column ReadColumn(const CsvLine& line, std::string_view cell) const;
  int FindSpec(const CsvLine& line, std::string_view cell) const;
  // Of the column that is read now, from 1.
  int NextNumber() const { return static_cast<int>(columns_.size()) + 1; }
  [[noreturn]] void FailUnknown(const CsvLine& line,
                                std::string_view cell) const;
  std::string DescribeNames(const ColumnSpec& spec) const;
  void RequireColumns() const;

  const std::string path_;
  const int line_;
  const TableContent& content_;
  std::vector<Column> columns_;
  std::vector<int> columns_of_;                      // by spec
  std::vector<std::pair<int, std::string>> filter_;  // column, text
  std::vector<std::pair<int, RowCondition>> exclude_;
};

/// Names that the columns of a table may have, one unit of each; joints come
/// last, where a long list is cut.
std::vector<std::string> ExpectedNames(const std::vector<ColumnSpec>& specs);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_TABLE_HEADER_H_
