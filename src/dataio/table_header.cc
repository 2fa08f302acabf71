#include "src/dataio/table_header.h"

#include <algorithm>
#include <optional>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// In our own format these are for people.
bool IsForPeople(std::string_view header) {
  return header == "comment" || header == "note" ||
         header.substr(0, 9) == "approach_";
}

// Quantities whose names are so particular that another unit is a mistake and
// not another quantity.
bool IsParticular(const ColumnSpec& spec) {
  return !spec.mapped.empty() || spec.rule == CellRule::kRequired ||
         spec.base == "x" || spec.base == "y" || spec.base == "z";
}

}  // namespace

TableHeader::TableHeader(const CsvLine& line, const TableContent& content)
    : path_(line.path),
      line_(line.number),
      content_(content),
      columns_of_(content.specs.size(), -1) {
  Cells cells;
  line.Split(&cells);
  Read(line, cells);
}

TableHeader::TableHeader(const CsvLine& line,
                         const std::vector<std::string>& names,
                         const TableContent& content)
    : path_(line.path),
      line_(line.number),
      content_(content),
      columns_of_(content.specs.size(), -1) {
  Cells cells;
  line.Split(&cells);
  // Where the line says them too, messages name places in it.
  cells.resize(std::max(cells.size(), names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (cells[i] != names[i]) cells[i] = names[i];
  }
  cells.resize(names.size());
  Read(line, cells);
}

void TableHeader::Read(const CsvLine& line, const Cells& cells) {
  RefuseOtherSeparators(line, cells);
  CheckNumJoints(cells);
  for (const std::string_view cell : cells) {
    columns_.push_back(ReadColumn(line, cell));
    const Column& column = columns_.back();
    if (column.spec < 0 || specs()[column.spec].is_ignored) continue;
    columns_of_[column.spec] = static_cast<int>(columns_.size()) - 1;
  }
  RequireColumns();
  ReadFilter();
}

int TableHeader::FindFilterColumn(const std::string& name,
                                  const char* use) const {
  std::vector<std::string> names;
  for (const Column& column : columns_) {
    const bool is_number = name == std::to_string(names.size() + 1);
    if (column.name == name || is_number) return static_cast<int>(names.size());
    names.push_back(column.name);
  }
  Fail(use + UnknownName("column", name, names), name);
}

void TableHeader::ReadFilter() {
  for (const auto& [name, text] : content_.where) {
    filter_.emplace_back(FindFilterColumn(name, "rows are chosen by it: "),
                         text);
  }
  for (const RowCondition& condition : content_.exclude) {
    exclude_.emplace_back(
        FindFilterColumn(condition.column, "`exclude` names it: "), condition);
  }
}

bool TableHeader::Keeps(const Cells& cells, const CsvDialect& dialect) const {
  return std::all_of(filter_.begin(), filter_.end(),
                     [&](const auto& entry) {
                       return cells[entry.first] == entry.second;
                     }) &&
         std::none_of(exclude_.begin(), exclude_.end(), [&](const auto& entry) {
           return entry.second.IsMet(cells[entry.first], dialect);
         });
}

std::string TableHeader::DescribeDefaultUnits() const {
  std::string text;
  for (const ColumnType type : {ColumnType::kAngle, ColumnType::kLength}) {
    std::vector<std::string> names;
    const Unit* unit = nullptr;
    for (const Column& column : columns_) {
      if (column.spec < 0 || StatesUnit(column.name)) continue;
      const ColumnSpec& spec = specs()[column.spec];
      if (spec.type != type || spec.default_unit == nullptr) continue;
      names.push_back(column.name);
      unit = spec.default_unit;
    }
    if (unit == nullptr) continue;
    text +=
        (text.empty() ? "" : ", ") + JoinNames(names) + " are in " + unit->name;
  }
  return text;
}

void TableHeader::Fail(const std::string& message,
                       const std::string& column) const {
  throw InputError({path_, line_, 0, column}, message);
}

std::vector<std::string> ExpectedNames(const std::vector<ColumnSpec>& specs) {
  std::vector<std::string> names;
  for (const bool joints : {false, true}) {
    for (const ColumnSpec& spec : specs) {
      const bool is_joint = spec.rule == CellRule::kRequired;
      if (is_joint == joints) names.push_back(FirstName(spec));
    }
  }
  return names;
}

void TableHeader::RefuseOtherSeparators(const CsvLine& line,
                                        const Cells& cells) const {
  if (cells.size() > 1) return;
  for (const auto& [separator, name] :
       {std::make_pair(';', "semicolons"), std::make_pair('\t', "tabs"),
        std::make_pair(' ', "spaces")}) {
    if (line.text.find(separator) == std::string_view::npos) continue;
    line.Fail(
        std::string("cells are separated by ") + name +
        ", but its rows do not say how: expected `separator` in the job's "
        "`data`, or commas");
  }
}

void TableHeader::CheckNumJoints(const Cells& cells) const {
  int num_joints = 0;
  for (const std::string_view cell : cells) {
    num_joints = std::max(num_joints, JointNumber(cell).value_or(0));
  }
  // A mapping names the joints one by one; what else begins with q is no
  // matter.
  const bool is_mapped = !specs().front().mapped.empty();
  const int num_motors = NumMotors(content_.arm);
  if (is_mapped || num_joints == 0 || num_joints == num_motors) return;
  Fail("data set has " + std::to_string(num_joints) + " joints, arm \"" +
       content_.arm.name + "\" has " + std::to_string(num_motors) +
       (HasFewerMotors(content_.arm) ? " motors" : ""));
}

// -1 where the column is passed over.
int TableHeader::FindSpec(const CsvLine& line, std::string_view cell) const {
  for (std::size_t i = 0; i < specs().size(); ++i) {
    const ColumnSpec& spec = specs()[i];
    if (!IsNamed(spec, cell, NextNumber())) continue;
    const bool has_unit =
        spec.type != ColumnType::kPlain && spec.type != ColumnType::kText;
    if (has_unit && UnitOf(spec, cell) == nullptr) {
      if (content_.ignore_others && !IsParticular(spec)) continue;
      line.Fail(DescribeBadUnit(spec, cell), cell.data(), std::string(cell));
    }
    return static_cast<int>(i);
  }
  const auto& where = content_.where;
  const auto& exclude = content_.exclude;
  const bool is_in_filter =
      std::any_of(where.begin(), where.end(),
                  [&](const auto& entry) { return entry.first == cell; }) ||
      std::any_of(exclude.begin(), exclude.end(),
                  [&](const auto& entry) { return entry.column == cell; });
  if (!content_.ignore_others && !is_in_filter && !IsForPeople(cell)) {
    FailUnknown(line, cell);
  }
  return -1;
}

void TableHeader::FailUnknown(const CsvLine& line,
                              std::string_view cell) const {
  std::string joints = FirstName(specs().front());
  if (NumMotors(content_.arm) > 1) {
    joints += " to " + FirstName(specs()[NumMotors(content_.arm) - 1]);
  }
  line.Fail(UnknownName("column", cell, ExpectedNames(specs())) +
                "; the arm's joints are " + joints +
                ". `columns` in the job's `data` says what other names mean, "
                "and `columns: {}` passes over what is not needed",
            cell.data());
}

TableHeader::Column TableHeader::ReadColumn(const CsvLine& line,
                                            std::string_view cell) const {
  Column column;
  column.name = cell;
  column.spec = FindSpec(line, cell);
  if (column.spec < 0) return column;
  const ColumnSpec& spec = specs()[column.spec];
  column.unit = UnitOf(spec, cell);
  for (const Column& other : columns_) {
    if (other.spec != column.spec) continue;
    line.Fail("repeated, expected " + Spellings(spec) +
                  " once (it is there as " + Quote(other.name) + ")" +
                  (spec.mapped.empty() ? "" : ", or the column's number"),
              cell.data(), column.name);
  }
  return column;
}

// What the header says instead of a quantity's name.
std::string TableHeader::DescribeNames(const ColumnSpec& spec) const {
  std::vector<std::string> names;
  std::vector<std::string> unread;
  for (const Column& column : columns_) {
    names.push_back(column.name);
    if (column.spec < 0) unread.push_back(column.name);
  }
  const auto nearest = NearestName(FirstName(spec), unread);
  return (nearest ? ", did you mean " + Quote(*nearest) + "? The" : "; the") +
         std::string(" columns are ") + JoinNames(names);
}

// What is required, and what a mapping names.
void TableHeader::RequireColumns() const {
  for (std::size_t i = 0; i < specs().size(); ++i) {
    const ColumnSpec& spec = specs()[i];
    const bool is_required =
        spec.rule == CellRule::kRequired || !spec.mapped.empty();
    if (!is_required || spec.is_ignored || columns_of_[i] >= 0) continue;
    const bool is_without_header = columns_[0].name == "1";
    Fail("column is missing, expected " + Spellings(spec) +
             (is_without_header ? " (the file has no header that fits its "
                                  "rows: columns go by their numbers, from 1)"
                                : DescribeNames(spec)),
         FirstName(spec));
  }
}

}  // namespace alidade::internal
