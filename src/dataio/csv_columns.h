#ifndef ALIDADE_SRC_DATAIO_CSV_COLUMNS_H_
#define ALIDADE_SRC_DATAIO_CSV_COLUMNS_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/arm.h"
#include "src/common/numbers.h"

namespace alidade::internal {

enum class ColumnType { kAngle, kLength, kSquareLength, kPlain, kText };

/// What a number must be.
enum class CellRule {
  kRequired,  ///< there, in every row
  kMeasured,  ///< there, or empty or "nan": not measured
  kPositive,  ///< as kMeasured, and above zero
};

/// A quantity that a data set may hold, under one of several column names.
struct ColumnSpec {
  std::string base;  ///< "q1", "x", "std_z"
  ColumnType type = ColumnType::kLength;
  CellRule rule = CellRule::kMeasured;
  /// The only header it has, where a mapping says so.
  std::string mapped = {};
  /// Known, but passed over.
  bool is_ignored = false;
  /// Of headers that state none; null = they must.
  const Unit* default_unit = nullptr;
};

/// The joints' columns (of coupled ones, the motors'): one required number
/// each.
std::vector<ColumnSpec> JointColumns(const Arm& arm);

/// Names that the columns may have, every unit after the other.
std::vector<std::string> ColumnNames(const std::vector<ColumnSpec>& specs);

/// The name with the first of its units: "q1_deg".
std::string FirstName(const ColumnSpec& spec);

/// "q1_deg or q1_rad"
std::string Spellings(const ColumnSpec& spec);

/// Whether the header of column `number` (from 1) of a file names the quantity,
/// whatever its unit: "q1_deg", "q1 [deg]"; a mapping may name it with its
/// unit, without one in brackets, or by the number.
bool IsNamed(const ColumnSpec& spec, std::string_view header, int number);

/// The unit that a header ends in, or the default one where it ends in none;
/// null where it is none of the column's. @pre the column has units.
const Unit* UnitOf(const ColumnSpec& spec, std::string_view header);

/// Whether the header says its unit itself.
bool StatesUnit(std::string_view header);

/// The header without its unit: "q1" of "q1_deg" and of "q1 [deg]".
std::string_view WithoutUnit(std::string_view header);

/// The unit of lengths or angles that a text is, as people write it: "mm",
/// "[deg]", "(inches)"; or null.
const Unit* FindHeaderUnit(std::string_view text);

/// Whether cells are units, some of lengths or angles among them ("mm"), others
/// of what else there is ("s", "[C]", "hh:mm:ss"). A few may be of neither kind
/// where most are lengths or angles: what a unit is called has no end.
bool AreUnits(const std::vector<std::string_view>& cells);

/// What is wrong with a header that UnitOf is null for, and what to do.
std::string DescribeBadUnit(const ColumnSpec& spec, std::string_view header);

/// "q12_deg", "q12 [deg]" -> 12; nothing where the name is no joint's.
std::optional<int> JointNumber(std::string_view name);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_CSV_COLUMNS_H_
