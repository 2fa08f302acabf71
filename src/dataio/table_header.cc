#include "src/dataio/table_header.h"

#include <algorithm>
#include <optional>

#include "src/common/names.h"
#include "src/common/numbers.h"

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

void TableHeader::ReadFilter() {
  for (const auto& [name, text] : content_.where) {
    int found = -1;
    std::vector<std::string> names;
    for (const Column& column : columns_) {
      if (column.name == name) found = static_cast<int>(names.size());
      names.push_back(column.name);
    }
    if (found < 0) {
      Fail("rows are chosen by it: " + UnknownName("column", name, names),
           name);
    }
    filter_.emplace_back(found, text);
  }
}

bool TableHeader::Keeps(const Cells& cells) const {
  return std::all_of(filter_.begin(), filter_.end(), [&](const auto& entry) {
    return cells[entry.first] == entry.second;
  });
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
    line.Fail(std::string("cells are separated by ") + name +
              ", expected commas, and points in decimal numbers");
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
  if (is_mapped || num_joints == 0 || num_joints == content_.arm.num_joints()) {
    return;
  }
  Fail("data set has " + std::to_string(num_joints) + " joints, arm \"" +
       content_.arm.name + "\" has " +
       std::to_string(content_.arm.num_joints()));
}

// -1 where the column is passed over.
int TableHeader::FindSpec(const CsvLine& line, std::string_view cell) const {
  for (std::size_t i = 0; i < specs().size(); ++i) {
    const ColumnSpec& spec = specs()[i];
    if (!IsNamed(spec, cell)) continue;
    const bool has_unit =
        spec.type != ColumnType::kPlain && spec.type != ColumnType::kText;
    if (has_unit && UnitOf(spec, cell) == nullptr) {
      if (content_.ignore_others && !IsParticular(spec)) continue;
      line.Fail(DescribeBadUnit(spec, cell), cell.data(), std::string(cell));
    }
    return static_cast<int>(i);
  }
  const auto& where = content_.where;
  const bool is_in_filter =
      std::any_of(where.begin(), where.end(),
                  [&](const auto& entry) { return entry.first == cell; });
  if (!content_.ignore_others && !is_in_filter && !IsForPeople(cell)) {
    FailUnknown(line, cell);
  }
  return -1;
}

void TableHeader::FailUnknown(const CsvLine& line,
                              std::string_view cell) const {
  if (ParseNumber(cell)) {
    line.Fail("found the number " + Quote(cell) +
                  ", expected a line of column names first: " +
                  JoinNames(ExpectedNames(specs())),
              cell.data());
  }
  std::string joints = FirstName(specs().front());
  if (content_.arm.num_joints() > 1) {
    joints += " to " + FirstName(specs()[content_.arm.num_joints() - 1]);
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
                  " once (it is there as " + Quote(other.name) + ")",
              cell.data(), column.name);
  }
  return column;
}

// What is required, and what a mapping names.
void TableHeader::RequireColumns() const {
  for (std::size_t i = 0; i < specs().size(); ++i) {
    const ColumnSpec& spec = specs()[i];
    const bool is_required =
        spec.rule == CellRule::kRequired || !spec.mapped.empty();
    if (!is_required || spec.is_ignored || columns_of_[i] >= 0) continue;
    Fail("column is missing, expected " + Spellings(spec), FirstName(spec));
  }
}

}  // namespace alidade::internal
