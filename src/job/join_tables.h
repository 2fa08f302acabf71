#ifndef ALIDADE_SRC_JOB_JOIN_TABLES_H_
#define ALIDADE_SRC_JOB_JOIN_TABLES_H_

#include <string>
#include <vector>

#include "src/dataio/csv_dialect.h"
#include "src/dataio/row_condition.h"

namespace alidade::internal {

/// One of two files, and what of it is left out.
struct TableToJoin {
  std::string path;
  LineRanges excluded_lines = {};
  /// Those on columns that the other file alone has are passed over.
  std::vector<RowCondition> exclude = {};
};

/// Two tables as one.
struct JoinedTables {
  std::string text;  ///< a CSV with the columns of both
  int num_rows = 0;
  /// How each is written, by which columns, what is left out.
  std::vector<std::string> notes;
};

/// Puts the rows of two files of other programs together that name the same
/// point: a controller's log of joint values and an instrument's list of
/// positions. `match` is the column that names the points, in one of the files
/// or in both, or "Point,Name", of each. In a file without such a column it is
/// the one with most of these names, where that is certain. Where no whole
/// names are the same their last parts count: "A::Cell7::P001" is "P001". Rows
/// whose point the other file does not have are left out, and noted. Numbers
/// are written with decimal points, whatever they had.
/// @throws InputError where there is no such column, where a point is there
/// twice, where no point is in both, and where a row is not whole.
JoinedTables JoinTables(const TableToJoin& first, const TableToJoin& second,
                        const std::string& match);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_JOIN_TABLES_H_
