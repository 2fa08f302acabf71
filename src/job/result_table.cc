#include "src/job/result_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/common/constants.h"
#include "src/common/number_text.h"
#include "src/dataio/csv_lines.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

// Numbers of a column; nothing where there is no such column.
const double* NumbersOf(const ResultTable& table, const std::string& name) {
  const int column = table.Column(name);
  return column < 0 ? nullptr : table.numbers[column].data();
}

// A column for each row; what was not measured is `missing`.
Eigen::MatrixXd MatrixOf(const ResultTable& table, const std::string& prefix,
                         double missing) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(
      3, static_cast<Eigen::Index>(table.num_rows), missing);
  for (int axis = 0; axis < 3; ++axis) {
    const double* const numbers =
        NumbersOf(table, prefix + "xyz"[axis] + "_mm");
    for (std::size_t row = 0; numbers && row < table.num_rows; ++row) {
      if (std::isnan(numbers[row])) continue;
      matrix(axis, static_cast<Eigen::Index>(row)) = numbers[row] * kMillimetre;
    }
  }
  return matrix;
}

// Angles as rotations about x.
Eigen::MatrixXd RotationsOf(const ResultTable& table, const std::string& name) {
  const double* const angles = NumbersOf(table, name);
  if (angles == nullptr) return {};
  Eigen::MatrixXd rotations =
      Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(table.num_rows));
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    if (std::isnan(angles[row])) continue;
    rotations(0, static_cast<Eigen::Index>(row)) = angles[row] * kDegree;
  }
  return rotations;
}

// A column per pose, which may have several rows or none.
Eigen::MatrixXd JointValuesOf(const ResultTable& table,
                              std::vector<Dimension>* dimensions) {
  dimensions->clear();
  std::vector<std::pair<const double*, double>> joints;
  for (int j = 1;; ++j) {
    const std::string name = "q" + std::to_string(j);
    const double* angles = NumbersOf(table, name + "_deg");
    const double* lengths = NumbersOf(table, name + "_mm");
    if (angles == nullptr && lengths == nullptr) break;
    dimensions->push_back(angles != nullptr ? Dimension::kAngle
                                            : Dimension::kLength);
    joints.emplace_back(angles != nullptr ? angles : lengths,
                        angles != nullptr ? kDegree : kMillimetre);
  }
  const double* const poses = NumbersOf(table, "pose");
  if (joints.empty() || poses == nullptr) return {};
  double num_poses = 0.0;
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    if (poses[row] > num_poses) num_poses = poses[row];
  }
  Eigen::MatrixXd values =
      Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(joints.size()),
                                static_cast<Eigen::Index>(num_poses), kNan);
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    if (!(poses[row] >= 1.0)) continue;
    const auto pose = static_cast<Eigen::Index>(poses[row]) - 1;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      values(static_cast<Eigen::Index>(j), pose) =
          joints[j].first[row] * joints[j].second;
    }
  }
  return values;
}

std::vector<ObservationLabel> LabelsOf(const ResultTable& table) {
  std::vector<ObservationLabel> labels;
  const int kind = table.Column("kind");
  if (kind < 0) return labels;
  const double* const poses = NumbersOf(table, "pose");
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    ObservationLabel label;
    label.kind = table.texts[kind][row];
    label.target = table.texts[table.Column("target")][row];
    label.where = table.texts[table.Column("where")][row];
    label.pose = std::isnan(poses[row]) ? -1 : static_cast<int>(poses[row]) - 1;
    label.has_length = !std::isnan(table.Number(row, "after_error_mm"));
    label.has_rotation = !std::isnan(table.Number(row, "after_rotation_deg"));
    labels.push_back(std::move(label));
  }
  return labels;
}

void ReadMap(const ResultTable& table, PredictedMap* map) {
  map->positions = MatrixOf(table, "", kNan);
  const auto fill = [&](const std::string& name, double unit, auto* values) {
    const double* const numbers = NumbersOf(table, name);
    if (numbers == nullptr) return;
    *values = Eigen::Map<const Eigen::VectorXd>(
                  numbers, static_cast<Eigen::Index>(table.num_rows)) *
              unit;
  };
  fill("position_std_mm", kMillimetre, &map->position_std);
  fill("rotation_std_deg", kDegree, &map->rotation_std);
  fill("true_error_mm", kMillimetre, &map->true_error);
  const auto count = static_cast<Eigen::Index>(table.num_rows);
  map->semi_axes.setZero(3, count);
  Eigen::VectorXd row;
  for (int k = 0; k < 3; ++k) {
    fill("axis" + std::to_string(k + 1) + "_mm", kMillimetre, &row);
    if (row.size() == count) map->semi_axes.row(k) = row;
  }
  for (int j = 0;; ++j) {
    const std::string name = "q" + std::to_string(j + 1);
    const bool is_angle = table.Column(name + "_deg") >= 0;
    if (!is_angle && table.Column(name + "_mm") < 0) break;
    fill(name + (is_angle ? "_deg" : "_mm"), is_angle ? kDegree : kMillimetre,
         &row);
    map->joint_values.conservativeResize(j + 1, count);
    map->joint_values.row(j) = row;
  }
}

// That the table is the result's: who has changed it by hand is told so.
void RequireTableOf(const EvaluatedSet& set, const std::string& path,
                    const ResultTable& table) {
  std::vector<std::string> needed = {"pose"};
  if (table.Column("kind") >= 0) {
    needed.insert(needed.end(), {"target", "where"});
  }
  for (const std::string& name : needed) {
    if (table.Column(name) >= 0) continue;
    throw InputError({path, 1, 0, name},
                     "no such column, expected the table that Alidade wrote");
  }
  if (table.num_rows < static_cast<std::size_t>(set.after.n)) {
    throw InputError({path, 0, 0, ""},
                     std::to_string(table.num_rows) +
                         " rows, expected one for each of the " +
                         std::to_string(set.after.n) +
                         " observations of result.json beside it");
  }
  // Differences alone have more poses than rows.
  const double most = 2.0 * static_cast<double>(table.num_rows);
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    if (!(table.Number(row, "pose") > most)) continue;
    throw InputError({path, static_cast<int>(row) + 2, 0, "pose"},
                     "no pose of this table has such a number");
  }
}

void ReadInfluence(const ResultTable& table, std::vector<Influence>* poses) {
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    poses->push_back({static_cast<int>(table.Number(row, "pose")) - 1, "",
                      table.Number(row, "leverage"),
                      table.Number(row, "cooks_distance"),
                      table.Number(row, "standardised_residual")});
  }
}

}  // namespace

int ResultTable::Column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1
                                : static_cast<int>(found - columns.begin());
}

double ResultTable::Number(std::size_t row, const std::string& name) const {
  const int column = Column(name);
  return column < 0 ? kNan : numbers[column][row];
}

ResultTable ReadResultTable(const MappedFile& file,
                            const std::set<std::string>& text_columns) {
  ResultTable table;
  std::vector<std::string_view> cells;
  CsvLine line{file.path(), {}, 0};
  for (std::string_view rest = file.text(); !rest.empty();) {
    line.text = TakeLine(&rest);
    ++line.number;
    line.Split(&cells);
    if (line.number == 1) {
      table.columns.assign(cells.begin(), cells.end());
      table.numbers.resize(cells.size());
      table.texts.resize(cells.size());
      continue;
    }
    ++table.num_rows;
    cells.resize(table.columns.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      table.numbers[k].push_back(NumberOrNan(cells[k]));
      if (text_columns.count(table.columns[k]) > 0) {
        table.texts[k].push_back(TextOf(cells[k]));
      }
    }
  }
  return table;
}

void ReadObservations(const ResultTable& table, EvaluatedSet* set) {
  set->joint_values = JointValuesOf(table, &set->joint_dimensions);
  set->labels = LabelsOf(table);
  set->positions = MatrixOf(table, "", kNan);
  set->residual_before = MatrixOf(table, "before_d", 0.0);
  set->residual_after = MatrixOf(table, "after_d", 0.0);
  set->rotation_residual_before = RotationsOf(table, "before_rotation_deg");
  set->rotation_residual_after = RotationsOf(table, "after_rotation_deg");
}

void ReadJointResiduals(const ResultTable& table, JointResiduals* residuals) {
  for (std::size_t row = 0; row < table.num_rows; ++row) {
    residuals->poses.push_back(static_cast<int>(table.Number(row, "pose")) - 1);
  }
  const auto append = [&](const std::string& name, double unit,
                          Eigen::MatrixXd* matrix) {
    const Eigen::Index row = matrix->rows();
    matrix->conservativeResize(row + 1,
                               static_cast<Eigen::Index>(table.num_rows));
    matrix->row(row).setConstant(kNan);
    const double* const numbers = NumbersOf(table, name);
    if (numbers == nullptr) return;
    matrix->row(row) =
        unit * Eigen::Map<const Eigen::RowVectorXd>(numbers, matrix->cols());
  };
  for (int j = 1;; ++j) {
    const std::string number = std::to_string(j);
    const bool is_angle = table.Column("q" + number + "_deg") >= 0;
    if (!is_angle && table.Column("q" + number + "_mm") < 0) break;
    const std::string unit = is_angle ? "_mrad" : "_mm";
    append("q" + number + (is_angle ? "_deg" : "_mm"),
           is_angle ? kDegree : kMillimetre, &residuals->joint_values);
    append("geometry" + number + unit, 1e-3, &residuals->geometry);
    append("remaining" + number + unit, 1e-3, &residuals->remaining);
  }
}

void ReadResultTables(const std::string& directory, CalibrationResult* result) {
  const auto read = [&directory](const char* name, const auto& take) {
    const std::string path = (fs::path(directory) / name).string();
    if (!fs::exists(path)) return;
    take(path, ReadResultTable(MappedFile(path), {"kind", "target", "where"}));
  };
  const auto read_set = [&read](const char* name, EvaluatedSet* set) {
    read(name, [&](const std::string& path, const ResultTable& table) {
      RequireTableOf(*set, path, table);
      ReadObservations(table, set);
    });
  };
  read_set("residuals.csv", &result->train);
  if (result->validation) {
    // The second is the name that results of format 1 have.
    for (const char* name : {"validation.csv", "heldout.csv"}) {
      read_set(name, &*result->validation);
    }
  }
  if (result->uncertainty && result->uncertainty->workspace) {
    read("predicted_map.csv",
         [&](const std::string& /*path*/, const ResultTable& table) {
           ReadMap(table, &*result->uncertainty->workspace);
         });
  }
  if (result->uncertainty) {
    read("influence.csv",
         [&](const std::string& /*path*/, const ResultTable& table) {
           ReadInfluence(table, &result->uncertainty->residuals.poses);
         });
  }
  if (result->error_terms) {
    read("joint_residuals.csv",
         [&](const std::string& /*path*/, const ResultTable& table) {
           ReadJointResiduals(table, &result->error_terms->residuals);
         });
  }
  const std::string arm = (fs::path(directory) / "arm.yaml").string();
  if (fs::exists(arm)) result->arm = LoadArm(arm);
}

}  // namespace alidade::internal
