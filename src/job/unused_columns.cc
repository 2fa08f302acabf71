#include "src/job/unused_columns.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>

#include "src/common/characters.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/common/yaml_text.h"
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
                      const ColumnRoles& roles, bool has_angles) {
  const std::vector<int>& position =
      roles.targets.empty() ? roles.position : roles.targets.front().second;
  std::vector<std::string> units;
  for (const std::vector<int>& group :
       {position, roles.joints,
        has_angles ? roles.angles : std::vector<int>()}) {
    if (group.empty()) continue;
    const ImportedColumn& column =
        columns[static_cast<std::size_t>(group.front()) - 1];
    if (!StatesUnit(column.name)) units.push_back(column.unit);
  }
  return units.empty() ? "" : ", unit: [" + JoinNames(units) + "]";
}

std::string ConditionText(const RowCondition& condition) {
  using Comparison = RowCondition::Comparison;
  static const std::map<Comparison, const char*> kMarks = {
      {Comparison::kEqual, " = "},        {Comparison::kUnequal, " != "},
      {Comparison::kLess, " < "},         {Comparison::kMore, " > "},
      {Comparison::kLessOrEqual, " <= "}, {Comparison::kMoreOrEqual, " >= "}};
  return condition.column + kMarks.at(condition.comparison) + condition.text;
}

std::string ExcludeText(const ImportedTable& table) {
  std::vector<std::string> entries;
  for (const auto& [first, last] : table.excluded.ranges()) {
    std::string entry = std::to_string(first);
    if (last > first) entry += "-";
    if (last > first && last < std::numeric_limits<int>::max()) {
      entry += std::to_string(last);
    }
    entries.push_back(entry);
  }
  for (const RowCondition& condition : table.request.exclude) {
    entries.push_back(QuotedYaml(ConditionText(condition)));
  }
  return entries.empty() ? "" : ", exclude: [" + Join(entries, ", ") + "]";
}

// What a job says of the file to read it as it is read here, and a covariate
// too.
std::string DataSection(const std::vector<ImportedColumn>& columns,
                        const ImportedTable& table,
                        const std::string& covariate) {
  namespace fs = std::filesystem;
  const ImportRequest& request = table.request;
  const std::string path = request.directory.empty()
                               ? request.path
                               : fs::proximate(fs::absolute(request.path),
                                               fs::absolute(request.directory))
                                     .string();
  ColumnRoles roles = table.roles;
  if (!request.rotation) roles.angles.clear();
  const bool has_angles = !roles.angles.empty();
  return "data: {file: " + YamlText(path) + ", columns: {" +
         DescribeMapping(roles, table.text.names()) +
         UnitsText(columns, roles, has_angles) + ", covariates: [" +
         YamlText(covariate) + "]}" +
         (has_angles ? ", rotation: " + request.rotation_name : "") +
         ExcludeText(table) + "}";
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
      "it from the file itself: `" +
      DataSection(columns, table, numbers.front()) + "`");
  return notes;
}

}  // namespace alidade::internal
