#ifndef ALIDADE_SRC_REPORT_RESULT_TABLE_H_
#define ALIDADE_SRC_REPORT_RESULT_TABLE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "src/common/text_pieces.h"

namespace alidade::internal {

/// A table as a result directory holds it, or some of its rows; cells as text.
struct ResultTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< a cell per column
  std::vector<std::size_t> index;  ///< which of the file's these are, from 0
  std::size_t total = 0;           ///< rows of the file

  /// -1 where there is no such column.
  int Column(const std::string& name) const;
  /// NaN where the cell holds no number.
  double Number(std::size_t row, int column) const;
};

/// Reads a CSV that Alidade wrote, the header first, twice. Of more rows than
/// `most_rows` so many are kept, spread evenly, and those of the largest
/// errors. Short rows are filled with empty cells, long ones cut. O(size) time,
/// a few numbers for each row in memory.
ResultTable ReadResultTable(const TextSource& csv, std::size_t most_rows);

/// {"total": rows of the table, "index": those that are here, from 1,
/// "columns": {name: [values]}}: numbers with the digits that a figure needs,
/// empty cells as null.
std::string TableJson(const ResultTable& table);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_RESULT_TABLE_H_
