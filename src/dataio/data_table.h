#ifndef ALIDADE_SRC_DATAIO_DATA_TABLE_H_
#define ALIDADE_SRC_DATAIO_DATA_TABLE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/shared_matrix.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/table_header.h"

namespace alidade::internal {

/// A row of a table, while it is visited.
class TableRow {
 public:
  TableRow(const TableRow&) = delete;
  TableRow& operator=(const TableRow&) = delete;

  /// SI value; NaN where it was not measured or there is no such column.
  double Number(int spec) const { return numbers_[spec]; }
  /// The cell's text; empty where there is no such column. Valid until the next
  /// call.
  virtual std::string_view Text(int spec) const = 0;

  /// Its number in the table, from 0; rows that the filter leaves out count.
  std::int64_t index() const { return index_; }
  int line() const { return line_; }
  /// Where the column's cell is; the whole line where there is no such column.
  virtual SourceLocation Location(int spec) const = 0;
  /// @throws InputError there.
  [[noreturn]] void Fail(int spec, const std::string& message) const;

 protected:
  explicit TableRow(const TableHeader& header);
  ~TableRow() = default;

  /// A column of numbers that is asked for.
  struct NumberColumn {
    int column;
    int spec;
    Unit unit;
    CellRule rule;
  };

  const TableHeader& header() const { return header_; }
  const std::vector<NumberColumn>& number_columns() const { return columns_; }
  void MoveTo(std::int64_t index, int line) {
    index_ = index;
    line_ = line;
  }
  /// Keeps the SI value of a cell, where its rule allows for it.
  void SetNumber(const NumberColumn& column, double value) {
    if (column.rule == CellRule::kPositive && value <= 0.0) {
      FailPositive(column.spec);
    }
    numbers_[column.spec] = value;
  }
  /// Says what is wrong with a cell that is no number.
  [[noreturn]] void FailNumber(const NumberColumn& column) const;

 private:
  [[noreturn]] void FailPositive(int spec) const;

  const TableHeader& header_;
  std::vector<NumberColumn> columns_;
  std::vector<double> numbers_;  // by spec
  std::int64_t index_ = 0;
  int line_ = 0;
};

/// The table of a data set's file, CSV or NPY, which is read in chunks of rows
/// by several threads. Numbers are read to the double nearest to their SI
/// value, a cell at a time: memory does not grow with the table.
class DataTable {
 public:
  using Visit = std::function<void(const TableRow& row)>;

  virtual ~DataTable() = default;
  DataTable(const DataTable&) = delete;
  DataTable& operator=(const DataTable&) = delete;

  virtual const TableHeader& header() const = 0;
  /// Those that the filter leaves out too.
  virtual std::int64_t num_rows() const = 0;

  /// Calls visit(row) of every row that the filter keeps, those of a chunk in
  /// their order, from `num_threads` threads. @throws InputError, the first
  /// in the table's order, where a cell breaks the rule of its column or
  /// visit() throws one.
  void VisitRows(int num_threads, const Visit& visit) const;

  /// The numbers of `count` quantities from `spec` on as they stand in the
  /// file, which they keep mapped: nothing where they are not side by side, in
  /// SI and as this machine's doubles, or the file is small.
  virtual std::optional<SharedMatrix> InPlace(int spec, int count) const;

  /// What was found out about the file and should be said, in one sentence;
  /// empty where it has the form of Alidade's own.
  virtual std::string Notes() const { return ""; }

  /// @throws InputError at the end of the file.
  [[noreturn]] void FailAtEnd(const std::string& message) const;

 protected:
  DataTable() = default;
  virtual std::int64_t num_chunks() const = 0;
  virtual void VisitChunk(std::int64_t chunk, const Visit& visit) const = 0;
  /// Its last line.
  virtual int num_lines() const = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATA_TABLE_H_
