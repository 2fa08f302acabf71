#include "src/job/unused_columns.h"

#include <algorithm>

#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/dataio/csv_columns.h"
#include "src/dataio/csv_dialect.h"

namespace alidade::internal {
namespace {

bool IsNumberIn(const ImportText& text, const std::string& cell) {
  return !PlainNumber(cell, text.dialect()).text().empty();
}

// Numbers that are no counter, which the first column may be, nor angles of an
// orientation.
std::vector<std::string> UnusedNumbers(
    const std::vector<ImportedColumn>& columns, const ImportedTable& table) {
  std::vector<std::string> numbers;
  const std::vector<int>& angles = table.roles.angles;
  for (std::size_t i = 1; i < columns.size(); ++i) {
    const bool is_angle =
        std::count(angles.begin(), angles.end(), static_cast<int>(i) + 1) > 0;
    if (!columns[i].use.empty() || is_angle) continue;
    if (IsNumberIn(table.text, columns[i].first)) {
      numbers.push_back(columns[i].name);
    }
  }
  return numbers;
}

// ", unit: [mm, rad]" of columns that do not state theirs.
std::string UnitsText(const std::vector<ImportedColumn>& columns,
                      const ColumnRoles& roles) {
  const std::vector<int>& position =
      roles.targets.empty() ? roles.position : roles.targets.front().second;
  std::vector<std::string> units;
  for (const std::vector<int>& group : {position, roles.joints}) {
    if (group.empty()) continue;
    const ImportedColumn& column =
        columns[static_cast<std::size_t>(group.front()) - 1];
    if (!StatesUnit(column.name)) units.push_back(column.unit);
  }
  return units.empty() ? "" : ", unit: [" + JoinNames(units) + "]";
}

}  // namespace

std::vector<std::string> NotesOnUnused(
    const std::vector<ImportedColumn>& columns, const ImportedTable& table) {
  const auto is_unused = [&](const std::string& name) {
    return std::any_of(
        columns.begin(), columns.end(), [&](const ImportedColumn& column) {
          return column.use.empty() && LowerCase(column.name) == name;
        });
  };
  std::vector<std::string> notes;
  if (is_unused("station")) {
    notes.emplace_back(
        "where the instrument stood is passed over: in the job, `data: {file: "
        "data.csv, stations: {NAME: FIRST-LAST, ...}}` gives each place a base "
        "of its own, by lines of that file");
  }
  if (is_unused("a") && is_unused("b") && is_unused("c")) {
    notes.emplace_back(
        "A, B and C are passed over: where they are KUKA's angles, rename them "
        "rz, ry and rx, and state --rotation=intrinsic_zyx");
    return notes;
  }
  const std::vector<std::string> numbers = UnusedNumbers(columns, table);
  if (numbers.empty()) return notes;
  notes.push_back(
      "numbers that are passed over: " + JoinNames(numbers) +
      "; where errors may depend on one (temperature, time, tilt), a job reads "
      "it from the file itself: `data: {file: " +
      table.path + ", columns: {" +
      DescribeMapping(table.roles, table.text.names()) +
      UnitsText(columns, table.roles) + ", covariates: [" + numbers.front() +
      "]}}`");
  return notes;
}

}  // namespace alidade::internal
