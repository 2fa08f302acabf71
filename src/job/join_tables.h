#ifndef ALIDADE_SRC_JOB_JOIN_TABLES_H_
#define ALIDADE_SRC_JOB_JOIN_TABLES_H_

#include <string>
#include <vector>

namespace alidade::internal {

/// Two tables as one.
struct JoinedTables {
  std::string text;  ///< a CSV with the columns of both
  int num_rows = 0;
  std::vector<std::string> notes;  ///< by which columns, what is left out
};

/// Puts the rows of two files of other programs together that name the same
/// point: a controller's log of joint values and an instrument's list of
/// positions. `column` names the points in one of the files or in both; in one
/// without such a column it is the one with most of these names. The last parts
/// of names count: "A::Cell7::P001" is "P001". Rows whose point the other file
/// does not have are left out, and noted. Numbers are written with decimal
/// points, whatever they had.
/// @throws InputError where there is no such column, where a point is there
/// twice, and where no point is in both.
JoinedTables JoinTables(const std::string& first, const std::string& second,
                        const std::string& column);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_JOIN_TABLES_H_
