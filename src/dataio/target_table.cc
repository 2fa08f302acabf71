#include "src/dataio/target_table.h"

#include <cmath>
#include <string_view>

#include "alidade/error.h"
#include "alidade/rotation.h"
#include "src/common/characters.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/dataio/csv_lines.h"
#include "src/dataio/csv_table.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

constexpr double kQuaternionNorm = 1e-3;  // of 1

// Where the groups of columns begin among the specs.
struct Groups {
  int joints = 0;
  int position;
  int angles;
  int quaternion;
  int vector;
  int pendant;  // A, B, C of KUKA, of frames alone
  int name;
};

enum class TableKind { kTargets, kFrames };

std::vector<ColumnSpec> MakeSpecs(const Arm& arm, TableKind kind,
                                  Groups* groups) {
  std::vector<ColumnSpec> specs = JointColumns(arm);
  // They need not be there; where they are, every row has them (Reader).
  for (ColumnSpec& spec : specs) spec.rule = CellRule::kMeasured;
  const auto add = [&](std::initializer_list<const char*> names,
                       ColumnType type) {
    const auto first = static_cast<int>(specs.size());
    for (const char* name : names) specs.push_back({name, type});
    return first;
  };
  groups->position = add({"x", "y", "z"}, ColumnType::kLength);
  groups->angles = add({"rx", "ry", "rz"}, ColumnType::kAngle);
  groups->quaternion = add({"qw", "qx", "qy", "qz"}, ColumnType::kPlain);
  groups->vector = add({"wx", "wy", "wz"}, ColumnType::kAngle);
  groups->name = add({"name"}, ColumnType::kText);
  groups->pendant = -1;
  if (kind == TableKind::kFrames) {
    groups->pendant = add({"a", "b", "c"}, ColumnType::kAngle);
  }
  return specs;
}

class TargetReader {
 public:
  TargetReader(const std::string& path, const Arm& arm,
               const std::optional<RotationConvention>& rotation,
               TableKind kind)
      : content_{arm, MakeSpecs(arm, kind, &groups_), true},
        csv_(MappedFile(path), content_, ReadOptions()),
        rotation_(rotation) {
    table_.path = path;
  }

  TargetTable Read() {
    CheckColumns();
    const TableHeader& header = csv_.header();
    table_.text = ReadFile(table_.path);
    table_.num_rows = csv_.num_rows();
    if (table_.num_rows == 0) csv_.FailAtEnd("no rows, expected targets");
    if (table_.has_joints) {
      table_.motors.resize(NumMotors(content_.arm), table_.num_rows);
    }
    if (table_.has_positions) {
      table_.poses.resize(static_cast<std::size_t>(table_.num_rows));
      table_.format.length =
          header.columns()[header.ColumnOf(groups_.position)].unit->name;
    }
    table_.numbers.setZero(3, table_.num_rows);
    csv_.VisitRows(1, [this](const TableRow& row) { ReadRow(row); });
    return std::move(table_);
  }

 private:
  bool HasAll(int first, int count) const {
    const TableHeader& header = csv_.header();
    int found = 0;
    for (int i = first; i < first + count; ++i) found += header.Has(i) ? 1 : 0;
    for (int i = first; found > 0 && i < first + count; ++i) {
      if (header.Has(i)) continue;
      header.Fail("column is missing, expected " + Spellings(content_.specs[i]),
                  FirstName(content_.specs[i]));
    }
    return found > 0;
  }

  void CheckColumns() {
    const TableHeader& header = csv_.header();
    // Columns are added to the text as it is.
    if (!csv_.Notes().empty()) {
      header.Fail(csv_.Notes() +
                  ": targets are read with commas between cells, decimal "
                  "points and a header in the first line");
    }
    table_.has_joints = HasAll(groups_.joints, NumMotors(content_.arm));
    table_.has_positions = HasAll(groups_.position, 3);
    PoseFormat& format = table_.format;
    format.form = OrientationForm::kNone;
    if (table_.has_joints && table_.has_positions && PosesAreEmpty()) {
      table_.has_positions = false;
      return;
    }
    if (groups_.pendant >= 0 && HasAll(groups_.pendant, 3)) {
      SetForm(OrientationForm::kAngles);
      format.rotation = *FindRotationConvention("intrinsic_zyx");
      return;
    }
    if (HasAll(groups_.angles, 3)) SetForm(OrientationForm::kAngles);
    if (HasAll(groups_.quaternion, 4)) SetForm(OrientationForm::kQuaternion);
    if (HasAll(groups_.vector, 3)) SetForm(OrientationForm::kVector);
    if (!table_.has_joints && !table_.has_positions) {
      header.Fail(
          "neither joint values (q1_deg ...) nor positions (x_mm, "
          "y_mm, z_mm), expected one of both");
    }
    if (format.form == OrientationForm::kAngles) {
      if (!rotation_) {
        header.Fail(
            std::string(
                "three angles state an orientation in many ways, expected ") +
                (groups_.pendant >= 0
                     ? "a_deg, b_deg, c_deg for A, B, C of a KUKA, or "
                       "--rotation=intrinsic_zyx where rx_deg is C, ry_deg B "
                       "and rz_deg A; else "
                     : "") +
                "--rotation=CONVENTION: " +
                JoinNames(RotationConventionNames()),
            header.NameOf(groups_.angles));
      }
      format.rotation = *rotation_;
    }
    const int first = FirstOf(format.form);
    if (first >= 0 && format.form != OrientationForm::kQuaternion) {
      format.angle = header.columns()[header.ColumnOf(first)].unit->name;
    }
  }

  // As in a data set that is to be filled in.
  bool PosesAreEmpty() const {
    std::vector<int> specs;
    for (int spec = groups_.position; spec < groups_.name; ++spec) {
      if (csv_.header().Has(spec)) specs.push_back(spec);
    }
    bool is_empty = true;
    csv_.VisitRows(1, [&](const TableRow& row) {
      for (const int spec : specs) {
        is_empty = is_empty && std::isnan(row.Number(spec));
      }
    });
    return is_empty;
  }

  void SetForm(OrientationForm form) {
    if (table_.format.form != OrientationForm::kNone) {
      csv_.header().Fail("states orientations twice, expected one of " +
                         csv_.header().NameOf(FirstOf(table_.format.form)) +
                         " and " + csv_.header().NameOf(FirstOf(form)));
    }
    table_.format.form = form;
  }

  int FirstOf(OrientationForm form) const {
    switch (form) {
      case OrientationForm::kAngles:
        return groups_.angles;
      case OrientationForm::kQuaternion:
        return groups_.quaternion;
      case OrientationForm::kVector:
        return groups_.vector;
      case OrientationForm::kNone:
        break;
    }
    return -1;
  }

  static double Number(const TableRow& row, int spec) {
    const double number = row.Number(spec);
    if (std::isnan(number)) row.Fail(spec, "expected a number");
    return number;
  }

  static Eigen::Vector3d Vector(const TableRow& row, int first) {
    return {Number(row, first), Number(row, first + 1), Number(row, first + 2)};
  }

  void ReadRow(const TableRow& row) {
    const Eigen::Index i = row.index();
    for (int j = 0; j < table_.motors.rows(); ++j) {
      table_.motors(j, i) = Number(row, j);
    }
    if (csv_.header().Has(groups_.name)) {
      table_.names.emplace_back(row.Text(groups_.name));
    }
    if (!table_.has_positions) return;
    Eigen::Isometry3d& pose = table_.poses[i];
    pose.setIdentity();
    pose.translation() = Vector(row, groups_.position);
    const OrientationForm form = table_.format.form;
    if (form == OrientationForm::kNone) return;
    if (form == OrientationForm::kQuaternion) {
      pose.linear() = ReadQuaternion(row);
      return;
    }
    if (groups_.pendant >= 0 && csv_.header().Has(groups_.pendant)) {
      table_.numbers.col(i) = Vector(row, groups_.pendant).reverse();
      pose.linear() = RotationOf(table_.format.rotation, table_.numbers.col(i));
      return;
    }
    table_.numbers.col(i) = Vector(row, FirstOf(form));
    pose.linear() =
        form == OrientationForm::kAngles
            ? RotationOf(table_.format.rotation, table_.numbers.col(i))
            : RotationFromVector<double>(table_.numbers.col(i));
  }

  Eigen::Matrix3d ReadQuaternion(const TableRow& row) const {
    const int first = groups_.quaternion;
    const Eigen::Vector3d vector = Vector(row, first + 1);
    Eigen::Quaterniond quaternion(Number(row, first), vector.x(), vector.y(),
                                  vector.z());
    if (std::abs(quaternion.norm() - 1.0) > kQuaternionNorm) {
      row.Fail(first, "the quaternion has the norm " +
                          ShortestNumber(quaternion.norm()) + ", expected 1");
    }
    return quaternion.normalized().toRotationMatrix();
  }

  Groups groups_;
  const TableContent content_;
  const CsvTable csv_;
  const std::optional<RotationConvention> rotation_;
  TargetTable table_;
};

// Decimals of a number in its unit: 1e-9 mm, 1e-10 deg, 1e-12 m or rad.
int DecimalsOf(const std::string& unit) {
  if (unit == "mm") return 9;
  return unit == "deg" ? 10 : 12;
}

void RefuseRepeated(const TargetTable& table, std::string_view header, int line,
                    const std::vector<AddedColumn>& columns) {
  std::vector<std::string_view> cells;
  const CsvLine csv{table.path, header, line};
  csv.Split(&cells);
  for (const AddedColumn& column : columns) {
    for (const std::string_view cell : cells) {
      if (cell != column.name) continue;
      csv.Fail("is there already, expected a table without it: " + column.name +
                   " is what is computed",
               cell.data(), column.name);
    }
  }
}

}  // namespace

TargetTable ReadTargets(const std::string& path, const Arm& arm,
                        const std::optional<RotationConvention>& rotation) {
  return TargetReader(path, arm, rotation, TableKind::kTargets).Read();
}

TargetTable ReadFrameTable(const std::string& path, const Arm& arm,
                           const std::optional<RotationConvention>& rotation) {
  return TargetReader(path, arm, rotation, TableKind::kFrames).Read();
}

std::string WithColumns(const TargetTable& table,
                        const std::vector<AddedColumn>& columns) {
  std::string text;
  std::string_view rest = table.text;
  std::int64_t row = -1;  // the header
  int number = 0;
  while (!rest.empty()) {
    const std::string_view before = rest;
    const std::string_view line = TakeLine(&rest);
    ++number;
    const std::string_view whole =
        before.substr(0, before.size() - rest.size());
    if (IsPassedOver(line)) {
      text += whole;
      continue;
    }
    if (row < 0) RefuseRepeated(table, line, number, columns);
    text += line;
    for (const AddedColumn& column : columns) {
      text += ',';
      text += row < 0 ? column.name : column.cells[row];
    }
    text += whole.substr(line.size());
    ++row;
  }
  return text;
}

AddedColumn NumberColumn(const std::string& name, const Eigen::VectorXd& values,
                         double scale, int decimals) {
  AddedColumn column{name, {}};
  column.cells.reserve(static_cast<std::size_t>(values.size()));
  for (const double value : values) {
    column.cells.push_back(FixedNumber(value / scale, decimals));
  }
  return column;
}

std::vector<AddedColumn> PoseColumns(
    const std::string& prefix, const std::vector<Eigen::Isometry3d>& poses,
    const PoseFormat& format, const Eigen::Matrix3Xd& near) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  const bool is_quaternion = format.form == OrientationForm::kQuaternion;
  Eigen::MatrixXd values(is_quaternion ? 7 : 6, count);
  RotationConvention convention = format.rotation;
  convention.is_vector = format.form != OrientationForm::kAngles;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Matrix3d rotation = poses[i].linear();
    values.col(i).head<3>() = poses[i].translation();
    if (is_quaternion) {
      const Eigen::Quaterniond quaternion(rotation);
      values.col(i).tail<4>() << quaternion.w(), quaternion.vec();
      continue;
    }
    const Eigen::Vector3d start =
        near.cols() > 0 ? near.col(i).eval() : Eigen::Vector3d::Zero();
    values.col(i).tail<3>() = NumbersOf(convention, rotation, start);
  }
  std::vector<AddedColumn> columns;
  const auto add = [&](const std::string& name, int row,
                       const std::string& unit) {
    const double scale = unit.empty() ? 1.0 : FindUnit(unit)->InSi();
    columns.push_back(
        NumberColumn(prefix + name + (unit.empty() ? "" : "_" + unit),
                     values.row(row), scale, DecimalsOf(unit)));
  };
  for (int k = 0; k < 3; ++k) {
    add(std::string(1, "xyz"[k]), k, format.length);
  }
  if (format.form == OrientationForm::kNone) return columns;
  for (int k = 0; is_quaternion && k < 4; ++k) {
    add(std::string("q") + "wxyz"[k], 3 + k, "");
  }
  for (int k = 0; !is_quaternion && k < 3; ++k) {
    add(std::string(convention.is_vector ? "w" : "r") + "xyz"[k], 3 + k,
        format.angle);
  }
  return columns;
}

std::vector<AddedColumn> MotorColumns(const std::string& prefix, const Arm& arm,
                                      const Eigen::MatrixXd& motors) {
  std::vector<AddedColumn> columns;
  const std::vector<Dimension> dimensions = MotorDimensions(arm);
  for (int j = 0; j < NumMotors(arm); ++j) {
    const bool turns = dimensions[j] == Dimension::kAngle;
    const std::string unit = turns ? "deg" : "mm";
    columns.push_back(
        NumberColumn(prefix + "q" + std::to_string(j + 1) + "_" + unit,
                     motors.row(j), FindUnit(unit)->InSi(), DecimalsOf(unit)));
  }
  return columns;
}

std::map<std::string, Eigen::Isometry3d> LoadFrames(
    const std::string& path, const Arm& arm,
    const std::optional<RotationConvention>& rotation) {
  const TargetTable table = ReadFrameTable(path, arm, rotation);
  if (table.names.empty() || !table.has_positions ||
      table.format.form == OrientationForm::kNone) {
    throw InputError({path, 0, 0, ""},
                     "expected the columns name, x_mm, y_mm, z_mm and an "
                     "orientation: wx_deg, wy_deg, wz_deg, or qw, qx, qy, qz, "
                     "or rx_deg, ry_deg, rz_deg with --rotation, or KUKA's A, "
                     "B, C as a_deg, b_deg, c_deg");
  }
  std::map<std::string, Eigen::Isometry3d> frames;
  for (std::size_t i = 0; i < table.poses.size(); ++i) {
    // RAPID makes no difference between small and capital letters.
    const std::string name = LowerCase(table.names[i]);
    if (frames.emplace(name, table.poses[i]).second) continue;
    throw InputError({path, 0, 0, "name"},
                     "\"" + table.names[i] + "\" stands twice, expected one");
  }
  return frames;
}

}  // namespace alidade::internal
