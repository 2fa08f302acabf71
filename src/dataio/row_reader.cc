#include "src/dataio/row_reader.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "src/common/names.h"
#include "src/common/numbers.h"

namespace alidade::internal {
namespace {

constexpr char kUnitHint[] = "state its unit in the column's name";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

bool IsNotMeasured(std::string_view cell) {
  if (cell.empty()) return true;
  if (cell.size() != 3) return false;
  const auto lower = [&](int i) { return static_cast<char>(cell[i] | 0x20); };
  return lower(0) == 'n' && lower(1) == 'a' && lower(2) == 'n';
}

RowReader::RowReader(MappedFile file, const Arm& arm,
                     std::vector<ColumnSpec> specs, bool ignore_others,
                     const Filter& where)
    : file_(std::move(file)),
      lines_(file_.path(), file_.text()),
      arm_(arm),
      specs_(std::move(specs)),
      ignore_others_(ignore_others),
      columns_of_(specs_.size(), -1),
      numbers_(specs_.size(), kNan) {
  for (const auto& [name, text] : where) filter_names_.push_back(name);
  RefuseOtherEncodings();
  ReadHeader();
  ReadFilter(where);
}

void RowReader::RefuseOtherEncodings() const {
  const std::string_view text = file_.text();
  const std::string_view mark = text.substr(0, 2);
  if (mark == "\xff\xfe" || mark == "\xfe\xff") {
    lines_.Fail(
        "the text is UTF-16, expected UTF-8: save the file as \"CSV UTF-8\"");
  }
  if (text.find('\0') != std::string_view::npos) {
    lines_.Fail("not a text file, expected comma-separated values");
  }
}

void RowReader::ReadHeader() {
  if (!lines_.Next()) {
    lines_.Fail("no header, expected a line of column names: " +
                JoinNames(ExpectedNames()));
  }
  lines_.Split(&cells_);
  RefuseOtherSeparators();
  CheckNumJoints();
  for (const std::string_view cell : cells_) {
    columns_.push_back(ReadColumn(cell));
    const Column& column = columns_.back();
    if (column.spec < 0 || specs_[column.spec].is_ignored) continue;
    columns_of_[column.spec] = static_cast<int>(columns_.size()) - 1;
  }
  RequireColumns();
}

void RowReader::ReadFilter(const Filter& where) {
  for (const auto& [name, text] : where) {
    int found = -1;
    std::vector<std::string> names;
    for (const Column& column : columns_) {
      if (column.name == name) found = static_cast<int>(names.size());
      names.push_back(column.name);
    }
    if (found < 0) {
      lines_.Fail(
          "rows are chosen by it: " + UnknownName("column", name, names),
          nullptr, name);
    }
    filter_.emplace_back(found, text);
  }
}

// One unit of each; joints come last, where a long list is cut.
std::vector<std::string> RowReader::ExpectedNames() const {
  std::vector<std::string> names;
  for (const bool joints : {false, true}) {
    for (const ColumnSpec& spec : specs_) {
      const bool is_joint = spec.rule == CellRule::kRequired;
      if (is_joint == joints) names.push_back(FirstName(spec));
    }
  }
  return names;
}

void RowReader::RefuseOtherSeparators() const {
  if (cells_.size() > 1) return;
  for (const auto& [separator, name] :
       {std::make_pair(';', "semicolons"), std::make_pair('\t', "tabs"),
        std::make_pair(' ', "spaces")}) {
    if (lines_.line().find(separator) == std::string_view::npos) continue;
    lines_.Fail(std::string("cells are separated by ") + name +
                ", expected commas, and points in decimal numbers");
  }
}

void RowReader::CheckNumJoints() const {
  int num_joints = 0;
  for (const std::string_view cell : cells_) {
    num_joints = std::max(num_joints, JointNumber(cell).value_or(0));
  }
  // A mapping names the joints one by one; what else begins with q is no
  // matter.
  const bool is_mapped = !specs_.front().mapped.empty();
  if (is_mapped || num_joints == 0 || num_joints == arm_.num_joints()) return;
  lines_.Fail("data set has " + std::to_string(num_joints) + " joints, arm \"" +
              arm_.name + "\" has " + std::to_string(arm_.num_joints()));
}

// -1 where the column is passed over.
int RowReader::FindSpec(std::string_view cell) const {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const ColumnSpec& spec = specs_[i];
    if (!IsNamed(spec, cell)) continue;
    const bool has_unit =
        spec.type != ColumnType::kPlain && spec.type != ColumnType::kText;
    if (has_unit && UnitOf(spec, cell) == nullptr) {
      if (ignore_others_ && !IsParticular(spec)) continue;
      lines_.Fail(DescribeBadUnit(spec, cell), cell.data(), std::string(cell));
    }
    return static_cast<int>(i);
  }
  const bool is_in_filter =
      std::find(filter_names_.begin(), filter_names_.end(), cell) !=
      filter_names_.end();
  if (!ignore_others_ && !is_in_filter && !IsForPeople(cell)) {
    FailUnknown(cell);
  }
  return -1;
}

void RowReader::FailUnknown(std::string_view cell) const {
  if (ParseNumber(cell)) {
    lines_.Fail("found the number " + Quote(cell) +
                    ", expected a line of column names first: " +
                    JoinNames(ExpectedNames()),
                cell.data());
  }
  std::string joints = FirstName(specs_.front());
  if (arm_.num_joints() > 1) {
    joints += " to " + FirstName(specs_[arm_.num_joints() - 1]);
  }
  lines_.Fail(UnknownName("column", cell, ExpectedNames()) +
                  "; the arm's joints are " + joints +
                  ". `columns` in the job's `data` says what other names stand "
                  "for, and `columns: {}` passes over what is not needed",
              cell.data());
}

RowReader::Column RowReader::ReadColumn(std::string_view cell) const {
  Column column;
  column.name = cell;
  column.spec = FindSpec(cell);
  if (column.spec < 0) return column;
  const ColumnSpec& spec = specs_[column.spec];
  column.unit = UnitOf(spec, cell);
  for (const Column& other : columns_) {
    if (other.spec != column.spec) continue;
    lines_.Fail("repeated, expected " + Spellings(spec) +
                    " once (it is there as " + Quote(other.name) + ")",
                cell.data(), column.name);
  }
  return column;
}

// What is required, and what a mapping names.
void RowReader::RequireColumns() const {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const ColumnSpec& spec = specs_[i];
    const bool is_required =
        spec.rule == CellRule::kRequired || !spec.mapped.empty();
    if (!is_required || spec.is_ignored || columns_of_[i] >= 0) continue;
    lines_.Fail("column is missing, expected " + Spellings(spec), nullptr,
                FirstName(spec));
  }
}

bool RowReader::Next() {
  while (lines_.Next()) {
    ++row_;
    lines_.Split(&cells_);
    CheckNumCells();
    if (!IsKept()) continue;
    ReadNumbers();
    return true;
  }
  return false;
}

void RowReader::CheckNumCells() const {
  if (cells_.size() == columns_.size()) return;
  std::string message = "expected " + std::to_string(columns_.size()) +
                        " cells as in the header, found " +
                        std::to_string(cells_.size());
  if (cells_.size() > columns_.size()) {
    message += ": numbers take a decimal point, not a comma";
  }
  lines_.Fail(message);
}

bool RowReader::IsKept() const {
  return std::all_of(filter_.begin(), filter_.end(), [&](const auto& entry) {
    return cells_[entry.first] == entry.second;
  });
}

void RowReader::ReadNumbers() {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    const ColumnSpec& spec = specs_[i];
    if (columns_of_[i] < 0 || spec.type == ColumnType::kText) continue;
    const std::string_view cell = cells_[columns_of_[i]];
    const int index = static_cast<int>(i);
    numbers_[i] = kNan;
    if (spec.rule != CellRule::kRequired && IsNotMeasured(cell)) continue;
    const Unit* unit = columns_[columns_of_[i]].unit;
    const std::optional<double> value =
        unit == nullptr ? ParseNumber(cell) : ParseQuantity(cell, *unit);
    if (!value) FailCell(index, DescribeBadNumber(cell, kUnitHint));
    if (spec.rule == CellRule::kPositive && !(*value > 0.0)) {
      const bool is_sigma = spec.base.rfind("std_", 0) == 0;
      FailCell(index, std::string("expected a ") +
                          (is_sigma ? "standard deviation" : "number") +
                          " above zero, found " + std::string(cell));
    }
    numbers_[i] = *value;
  }
}

std::string_view RowReader::Text(int spec) const {
  return Has(spec) ? cells_[columns_of_[spec]] : std::string_view();
}

SourceLocation RowReader::CellLocation(int spec) const {
  SourceLocation location;
  location.file = path();
  location.line = lines_.line_number();
  if (!Has(spec)) return location;
  location.column = lines_.ColumnOf(cells_[columns_of_[spec]].data());
  location.key = columns_[columns_of_[spec]].name;
  return location;
}

void RowReader::FailCell(int spec, const std::string& message) const {
  throw InputError(CellLocation(spec), message);
}

void RowReader::Fail(const std::string& message,
                     const std::string& column) const {
  lines_.Fail(message, nullptr, column);
}

}  // namespace alidade::internal
