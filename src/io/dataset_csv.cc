#include "alidade/io/dataset_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/files.h"
#include "src/io/csv_lines.h"
#include "src/io/names.h"
#include "src/io/numbers.h"

namespace alidade {
namespace {

constexpr char kUnitHint[] = "state its unit in the column's name";

// A quantity that a data set holds, under one of several column names.
struct Quantity {
  std::string base;  // "q1", "x", "std_z"
  Dimension dimension;
  bool must_be_positive = false;
  std::string mapped = {};  // the only header it has, where a mapping says so
};

// What a cell of a row is: a quantity in a unit, or nothing of interest.
struct Column {
  std::string name;
  int quantity = -1;  // row of the table, -1 = ignored
  const Unit* unit = nullptr;
};

// The units that a data set may be written in.
std::vector<std::string> ColumnUnits(Dimension dimension) {
  if (dimension == Dimension::kLength) return {"mm", "m"};
  return {"deg", "rad"};
}

std::vector<Quantity> JointQuantities(const Arm& arm) {
  std::vector<Quantity> quantities;
  for (int j = 0; j < arm.num_joints(); ++j) {
    const bool is_revolute = arm.joints[j].type == JointType::kRevolute;
    quantities.push_back(
        {"q" + std::to_string(j + 1),
         is_revolute ? Dimension::kAngle : Dimension::kLength});
  }
  return quantities;
}

// Position and sigma follow the joints, three rows each.
std::vector<Quantity> AllQuantities(const Arm& arm) {
  std::vector<Quantity> quantities = JointQuantities(arm);
  for (const char* name : {"x", "y", "z"}) {
    quantities.push_back({name, Dimension::kLength});
  }
  for (const char* name : {"std_x", "std_y", "std_z"}) {
    quantities.push_back({name, Dimension::kLength, true});
  }
  return quantities;
}

std::vector<std::string> ColumnNames(const std::vector<Quantity>& quantities) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) {
    if (!quantity.mapped.empty()) {
      names.push_back(quantity.mapped);
      continue;
    }
    for (const std::string& unit : ColumnUnits(quantity.dimension)) {
      names.push_back(quantity.base + "_" + unit);
    }
  }
  return names;
}

// "q1_deg or q1_rad"
std::string Spellings(const Quantity& quantity) {
  const std::vector<std::string> names = ColumnNames({quantity});
  return names.size() == 1 ? names[0] : names[0] + " or " + names[1];
}

// Whether a header of the file names the quantity, whatever its unit.
bool IsNamed(const Quantity& quantity, std::string_view header) {
  if (!quantity.mapped.empty()) return header == quantity.mapped;
  return header.substr(0, header.rfind('_')) == quantity.base;
}

// "q12_deg" -> 12; nothing where the name is no joint's.
std::optional<int> JointNumber(std::string_view name) {
  if (name.size() < 2 || name.front() != 'q') return std::nullopt;
  const std::string_view digits = name.substr(1, name.find('_') - 1);
  int number = 0;
  const char* const end = digits.data() + digits.size();
  const std::from_chars_result result =
      std::from_chars(digits.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end || number < 1) {
    return std::nullopt;
  }
  return number;
}

// Reads the columns of `quantities`; the table has one row for each of them.
class TableReader {
 public:
  TableReader(const std::string& path, const Arm& arm,
              std::vector<Quantity> quantities, bool ignore_others)
      : path_(path),
        text_(ReadFile(path)),
        lines_(path_, text_),
        arm_(arm),
        quantities_(std::move(quantities)),
        ignore_others_(ignore_others) {}

  Eigen::MatrixXd Read() {
    ReadHeader();
    Eigen::MatrixXd table(static_cast<int>(quantities_.size()),
                          std::count(text_.begin(), text_.end(), '\n') + 1);
    Eigen::Index num_rows = 0;
    while (lines_.Next()) {
      ReadRow(table.col(num_rows));
      ++num_rows;
    }
    if (num_rows == 0) {
      lines_.Fail("no rows behind the header, expected one for every pose");
    }
    table.conservativeResize(Eigen::NoChange, num_rows);
    return table;
  }

  // After Read().
  bool Has(const std::string& base) const {
    return std::any_of(columns_.begin(), columns_.end(), [&](const Column& c) {
      return c.quantity >= 0 && quantities_[c.quantity].base == base;
    });
  }

 private:
  void ReadHeader() {
    if (text_.find('\0') != std::string::npos) {
      lines_.Fail("not a text file, expected comma-separated values");
    }
    if (!lines_.Next()) {
      lines_.Fail("no header, expected a line of column names: " +
                  JoinNames(ExpectedNames()));
    }
    lines_.Split(&cells_);
    RefuseOtherSeparators();
    CheckNumJoints();
    for (const std::string_view cell : cells_) {
      columns_.push_back(ReadColumn(cell));
    }
    RequireAll();
  }

  // One unit of each; joints come last, where a long list is cut.
  std::vector<std::string> ExpectedNames() const {
    std::vector<std::string> names;
    for (const bool joints : {false, true}) {
      for (const Quantity& quantity : quantities_) {
        if (JointNumber(quantity.base).has_value() != joints) continue;
        names.push_back(ColumnNames({quantity}).front());
      }
    }
    return names;
  }

  void RefuseOtherSeparators() const {
    if (cells_.size() > 1) return;
    for (const auto& [separator, name] :
         {std::make_pair(';', "semicolons"), std::make_pair('\t', "tabs")}) {
      if (lines_.line().find(separator) == std::string_view::npos) continue;
      lines_.Fail(std::string("cells are separated by ") + name +
                  ", expected commas, and points in decimal numbers");
    }
  }

  void CheckNumJoints() const {
    int num_joints = 0;
    for (const std::string_view cell : cells_) {
      num_joints = std::max(num_joints, JointNumber(cell).value_or(0));
    }
    // A mapping names the joints one by one; what else begins with q is no
    // matter.
    const bool is_mapped = !quantities_.front().mapped.empty();
    if (is_mapped || num_joints == 0 || num_joints == arm_.num_joints()) return;
    lines_.Fail("data set has " + std::to_string(num_joints) +
                " joints, arm \"" + arm_.name + "\" has " +
                std::to_string(arm_.num_joints()));
  }

  Column ReadColumn(std::string_view cell) const {
    Column column;
    column.name = cell;
    for (std::size_t i = 0; i < quantities_.size(); ++i) {
      if (IsNamed(quantities_[i], cell)) column.quantity = static_cast<int>(i);
    }
    if (column.quantity < 0) {
      if (ignore_others_) return column;
      lines_.Fail(UnknownName("column", cell, ExpectedNames()), cell.data());
    }
    const Quantity& quantity = quantities_[column.quantity];
    column.unit = ReadUnit(cell, quantity);
    for (const Column& other : columns_) {
      if (other.quantity != column.quantity) continue;
      lines_.Fail("repeated, expected " + Spellings(quantity) +
                      " once (it is there as " + Quote(other.name) + ")",
                  cell.data(), column.name);
    }
    return column;
  }

  const Unit* ReadUnit(std::string_view cell, const Quantity& quantity) const {
    const std::size_t underscore = std::min(cell.rfind('_'), cell.size());
    const std::string name(cell.substr(std::min(cell.size(), underscore + 1)));
    const std::vector<std::string> fitting = ColumnUnits(quantity.dimension);
    if (std::find(fitting.begin(), fitting.end(), name) == fitting.end()) {
      const std::string problem =
          name.empty() ? "no unit" : "unit " + Quote(name) + " does not fit";
      lines_.Fail(problem + ": " + quantity.base + " is " +
                      (quantity.dimension == Dimension::kAngle ? "an angle"
                                                               : "a length") +
                      ", expected " + Spellings(quantity),
                  cell.data(), std::string(cell));
    }
    return FindUnit(name);
  }

  // Sigmas are optional, but only all three together.
  void RequireAll() const {
    const bool has_sigmas = Has("std_x") || Has("std_y") || Has("std_z");
    for (const Quantity& quantity : quantities_) {
      if (quantity.must_be_positive && !has_sigmas) continue;
      if (Has(quantity.base)) continue;
      lines_.Fail("column is missing, expected " + Spellings(quantity), nullptr,
                  ColumnNames({quantity}).front());
    }
  }

  void CheckNumCells() const {
    if (cells_.size() == columns_.size()) return;
    std::string message = "expected " + std::to_string(columns_.size()) +
                          " cells as in the header, found " +
                          std::to_string(cells_.size());
    if (cells_.size() > columns_.size()) {
      message += ": numbers take a decimal point, not a comma";
    }
    lines_.Fail(message);
  }

  void ReadRow(Eigen::Ref<Eigen::VectorXd> values) {
    lines_.Split(&cells_);
    CheckNumCells();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Column& column = columns_[i];
      if (column.quantity < 0) continue;
      const std::optional<double> value =
          ParseQuantity(cells_[i], *column.unit);
      if (!value) FailCell(i, DescribeBadNumber(cells_[i], kUnitHint));
      if (quantities_[column.quantity].must_be_positive && !(*value > 0.0)) {
        FailCell(i, "expected a standard deviation above zero, found " +
                        std::string(cells_[i]));
      }
      values[column.quantity] = *value;
    }
  }

  [[noreturn]] void FailCell(std::size_t i, const std::string& message) const {
    lines_.Fail(message, cells_[i].data(), columns_[i].name);
  }

  const std::string path_;
  const std::string text_;
  CsvLines lines_;
  const Arm& arm_;
  const std::vector<Quantity> quantities_;
  const bool ignore_others_;
  std::vector<Column> columns_;
  std::vector<std::string_view> cells_;
};

// Rounding must not leave "-0.0000".
std::string FormatFixed(double value, int decimals) {
  std::array<char, 400> buffer;
  const std::to_chars_result result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                    std::chars_format::fixed, decimals);
  std::string text(buffer.data(), result.ptr);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

std::string FormatHeader(const Arm& arm, bool with_sigmas) {
  std::string header;
  for (const Quantity& quantity : AllQuantities(arm)) {
    if (quantity.must_be_positive && !with_sigmas) continue;
    if (!header.empty()) header += ",";
    header += ColumnNames({quantity}).front();
  }
  return header;
}

void AppendPoint(const Eigen::Vector3d& point, std::string* text) {
  for (const double coordinate : point) {
    *text += "," + FormatShifted(coordinate, 3);
  }
}

Dataset ReadDataset(const std::string& path, const Arm& arm,
                    double default_sigma, TableReader* reader) {
  const Eigen::MatrixXd table = reader->Read();
  const int num_joints = arm.num_joints();
  Dataset dataset;
  dataset.name = path;
  dataset.joint_values = JointsFromMotors(arm, table.topRows(num_joints));
  dataset.positions = table.middleRows<3>(num_joints);
  if (reader->Has("std_x")) {
    dataset.sigmas = table.bottomRows<3>();
  } else {
    dataset.sigmas.setConstant(3, table.cols(), default_sigma);
  }
  return dataset;
}

}  // namespace

Dataset LoadDataset(const std::string& path, const Arm& arm,
                    double default_sigma) {
  TableReader reader(path, arm, AllQuantities(arm), false);
  return ReadDataset(path, arm, default_sigma, &reader);
}

Dataset LoadMappedDataset(const std::string& path, const Arm& arm,
                          double default_sigma, const ColumnMapping& mapping) {
  std::vector<Quantity> quantities = AllQuantities(arm);
  for (std::size_t j = 0; j < mapping.joints.size(); ++j) {
    quantities[j].mapped = mapping.joints[j];
  }
  for (std::size_t axis = 0; axis < mapping.position.size(); ++axis) {
    quantities[arm.num_joints() + axis].mapped = mapping.position[axis];
  }
  TableReader reader(path, arm, std::move(quantities), true);
  return ReadDataset(path, arm, default_sigma, &reader);
}

Eigen::MatrixXd LoadJointValues(const std::string& path, const Arm& arm) {
  return JointsFromMotors(
      arm, TableReader(path, arm, JointQuantities(arm), true).Read());
}

std::string FormatDataset(const Dataset& dataset, const Arm& arm,
                          int joint_decimals, bool with_sigmas,
                          const std::vector<std::string>& comments) {
  const Eigen::MatrixXd motors = MotorsFromJoints(arm, dataset.joint_values);
  std::string text;
  for (const std::string& comment : comments) {
    text += "# " + OneLine(comment) + "\n";
  }
  text += FormatHeader(arm, with_sigmas) + "\n";
  for (Eigen::Index i = 0; i < dataset.num_poses(); ++i) {
    for (int j = 0; j < dataset.num_joints(); ++j) {
      const bool is_revolute = arm.joints[j].type == JointType::kRevolute;
      const double unit = is_revolute ? kDegree : kMillimetre;
      if (j > 0) text += ",";
      text += FormatFixed(motors(j, i) / unit, joint_decimals);
    }
    AppendPoint(dataset.positions.col(i), &text);
    if (with_sigmas) AppendPoint(dataset.sigmas.col(i), &text);
    text += "\n";
  }
  return text;
}

}  // namespace alidade
