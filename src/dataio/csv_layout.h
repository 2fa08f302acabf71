#ifndef ALIDADE_SRC_DATAIO_CSV_LAYOUT_H_
#define ALIDADE_SRC_DATAIO_CSV_LAYOUT_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "src/dataio/csv_dialect.h"

namespace alidade::internal {

/// Where a text has its table and how it is written.
struct CsvLayout {
  CsvDialect dialect;
  int header_line = 0;             ///< from 1; 0 = none
  std::vector<std::string> names;  ///< of the columns; "1", "2" ... without one
  std::size_t rows = 0;            ///< where lines of rows may begin
  int lines_before_rows = 0;
  /// What is other than in Alidade's own files, each for people: "cells are
  /// separated by semicolons".
  std::vector<std::string> notes;
};

/// Finds the table in a text, where that is certain:
///
///   - the separator is the one by which most lines have equally many cells, at
///     least two of them numbers, most of all ("sep=;" in the first line says
///     it as well);
///   - numbers have decimal commas, or marks of thousands, where some cell
///     cannot be read otherwise and no cell contradicts;
///   - the header is the last line before the first row of numbers that has as
///     many cells; a line of units between them is taken into the names, and
///     where a name is there twice, what stands above it; a comment in that
///     place is a header too;
///   - without one columns are called by their numbers.
///
/// A text that has no such rows is one of Alidade's own form, with the header
/// in the first line that is no comment. @throws InputError where two readings
/// are possible: the message says what to state in the job.
CsvLayout FindCsvLayout(const std::string& path, std::string_view text,
                        const StatedDialect& stated);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_LAYOUT_H_
