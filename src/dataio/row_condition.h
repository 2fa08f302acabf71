#ifndef ALIDADE_SRC_DATAIO_ROW_CONDITION_H_
#define ALIDADE_SRC_DATAIO_ROW_CONDITION_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "src/dataio/csv_dialect.h"

namespace alidade::internal {

/// A condition on one cell of a row: "status = lost", "rms_mm > 0.05". Numbers
/// are compared as such, in the column's own unit.
struct RowCondition {
  enum class Comparison {
    kEqual,
    kUnequal,
    kLess,
    kLessOrEqual,
    kMore,
    kMoreOrEqual
  };
  std::string column;
  Comparison comparison = Comparison::kEqual;
  std::string text;

  /// False where a number is wanted and the cell is none.
  bool IsMet(std::string_view cell, const CsvDialect& dialect) const;
};

/// Reads "COLUMN = TEXT", with one of = == != < <= > >=; nothing where the text
/// is no condition.
std::optional<RowCondition> ParseRowCondition(std::string_view text);

/// First and last line of "12", "40-45" or "46-", to the end; nothing where the
/// text is none of these.
std::optional<std::pair<int, int>> ParseLines(std::string_view text);

/// How a row is left out of the data that a job or a command reads, for the
/// message of what is wrong with it: "`exclude: [12]` in the job's `data`, or
/// --exclude=12 of `import`, leaves the row out".
std::string HowToExclude(int line);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_ROW_CONDITION_H_
