#ifndef ALIDADE_SRC_DATAIO_ROW_READER_H_
#define ALIDADE_SRC_DATAIO_ROW_READER_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/error.h"
#include "src/common/mapped_file.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {

/// Reads the rows of a CSV file one by one, by the columns that its header
/// names. Columns are asked for by their index in `specs`.
class RowReader {
 public:
  /// Texts that rows must have to be read: column, cell.
  using Filter = std::vector<std::pair<std::string, std::string>>;

  /// A column of the file.
  struct Column {
    std::string name;
    int spec = -1;  ///< -1 = passed over
    const Unit* unit = nullptr;
  };

  /// Reads the header. The joints come first in `specs`. @throws InputError
  /// where a column of the file is unknown (unless others are ignored) or
  /// repeated, its unit does not fit, or a required one is missing.
  RowReader(MappedFile file, const Arm& arm, std::vector<ColumnSpec> specs,
            bool ignore_others, const Filter& where = {});
  RowReader(const RowReader&) = delete;
  RowReader& operator=(const RowReader&) = delete;

  /// The next row that the filter keeps, or false at the end of the file.
  /// @throws InputError where a cell breaks the rule of its column.
  bool Next();

  /// Whether the file has the column.
  bool Has(int spec) const { return columns_of_[spec] >= 0; }
  /// SI value; NaN where it was not measured or there is no such column.
  double Number(int spec) const { return numbers_[spec]; }
  /// The cell's text; empty where there is no such column.
  std::string_view Text(int spec) const;

  const std::string& path() const { return file_.path(); }
  /// The columns of the file, in its order.
  const std::vector<Column>& columns() const { return columns_; }
  /// What stands after the line that was read last (the header, at first).
  std::string_view rest() const { return lines_.rest(); }
  int line() const { return lines_.line_number(); }
  /// Number of the row in the file, counted from 1; those that the filter
  /// leaves out count too.
  int row() const { return row_; }

  /// Where the column's cell stands in the row read last; the whole line where
  /// there is no such column.
  SourceLocation CellLocation(int spec) const;
  /// @throws InputError there.
  [[noreturn]] void FailCell(int spec, const std::string& message) const;
  /// @throws InputError at the line read last (the header, at first). `column`
  /// is its name.
  [[noreturn]] void Fail(const std::string& message,
                         const std::string& column = "") const;

 private:
  void RefuseOtherEncodings() const;
  void ReadHeader();
  void ReadFilter(const Filter& where);
  std::vector<std::string> ExpectedNames() const;
  void RefuseOtherSeparators() const;
  void CheckNumJoints() const;
  Column ReadColumn(std::string_view cell) const;
  int FindSpec(std::string_view cell) const;
  [[noreturn]] void FailUnknown(std::string_view cell) const;
  void RequireColumns() const;
  void CheckNumCells() const;
  bool IsKept() const;
  void ReadNumbers();

  const MappedFile file_;
  CsvLines lines_;
  const Arm& arm_;
  const std::vector<ColumnSpec> specs_;
  const bool ignore_others_;
  std::vector<Column> columns_;
  std::vector<int> columns_of_;  // by spec; -1 = the file has none
  std::vector<std::pair<int, std::string>> filter_;  // column, text
  std::vector<std::string> filter_names_;
  std::vector<std::string_view> cells_;
  std::vector<double> numbers_;  // by spec
  int row_ = 0;
};

/// Whether a cell says that nothing was measured: empty, or "nan".
bool IsNotMeasured(std::string_view cell);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROW_READER_H_
