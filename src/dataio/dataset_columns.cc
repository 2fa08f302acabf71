#include "src/dataio/dataset_columns.h"

#include <algorithm>
#include <string>

#include "src/common/names.h"

namespace alidade::internal {
namespace {

using Headers = std::vector<std::string>;

// Appends a column for each name and returns the index of the first.
int Add(const Headers& names, ColumnType type, CellRule rule,
        const Headers& mapped, std::vector<ColumnSpec>* specs) {
  const auto first = static_cast<int>(specs->size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    specs->push_back(
        {names[i], type, rule, mapped.empty() ? "" : mapped[i], false});
  }
  return first;
}

int AddText(const std::string& name, const std::string& mapped,
            std::vector<ColumnSpec>* specs) {
  const Headers headers = mapped.empty() ? Headers() : Headers{mapped};
  return Add({name}, ColumnType::kText, CellRule::kMeasured, headers, specs);
}

void AddPositions(const ColumnMapping& mapping, DatasetColumns* columns) {
  std::vector<ColumnSpec>* specs = &columns->specs;
  columns->position = Add({"x", "y", "z"}, ColumnType::kLength,
                          CellRule::kMeasured, mapping.position, specs);
  columns->position_sigma =
      Add({"std_x", "std_y", "std_z"}, ColumnType::kLength, CellRule::kPositive,
          mapping.std_position, specs);
}

void AddOrientations(const ColumnMapping& mapping, DatasetColumns* columns) {
  const Headers& mapped = mapping.orientation;
  const bool is_quaternion = mapped.size() == 4;
  const bool is_angles = mapped.size() == 3;
  std::vector<ColumnSpec>* specs = &columns->specs;
  const Headers& sigmas = mapping.std_orientation;
  columns->angles =
      Add({"rx", "ry", "rz"}, ColumnType::kAngle, CellRule::kMeasured,
          is_angles ? mapped : Headers(), specs);
  columns->quaternion =
      Add({"qw", "qx", "qy", "qz"}, ColumnType::kPlain, CellRule::kMeasured,
          is_quaternion ? mapped : Headers(), specs);
  columns->matrix =
      Add({"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"},
          ColumnType::kPlain, CellRule::kMeasured,
          mapped.size() == 9 ? mapped : Headers(), specs);
  columns->vector = Add({"wx", "wy", "wz"}, ColumnType::kAngle,
                        CellRule::kMeasured, {}, specs);
  columns->angle_sigma =
      Add({"std_rx", "std_ry", "std_rz"}, ColumnType::kAngle,
          CellRule::kPositive, mapped.size() > 3 ? Headers() : sigmas, specs);
  columns->turn_sigma =
      Add({"std_wx", "std_wy", "std_wz"}, ColumnType::kAngle,
          CellRule::kPositive, mapped.size() > 3 ? sigmas : Headers(), specs);
}

void Ignore(int first, int count, DatasetColumns* columns) {
  for (int i = first; i < first + count; ++i) {
    columns->specs[i].is_ignored = true;
  }
}

// A mapping that names one way to state a quantity leaves no room for the
// others.
void IgnoreOthers(const DataFormat& format, DatasetColumns* columns) {
  const ColumnMapping& mapping = format.columns;
  const std::size_t given = mapping.orientation.size();
  const bool no_rotation = format.ignore_rotation;
  if (no_rotation || given > 3) {
    Ignore(columns->angles, 3, columns);
    Ignore(columns->angle_sigma, 3, columns);
  }
  if (no_rotation || given == 3 || given == 9) {
    Ignore(columns->quaternion, 4, columns);
  }
  if (no_rotation || given == 3 || given == 4) {
    Ignore(columns->matrix, 9, columns);
  }
  if (no_rotation || given > 0) Ignore(columns->vector, 3, columns);
  if (no_rotation) Ignore(columns->turn_sigma, 3, columns);
  if (format.poses_only) {
    for (const int text :
         {columns->distance, columns->distance_sigma, columns->point.front(),
          columns->plane, columns->from, columns->set, columns->station}) {
      Ignore(text, 1, columns);
    }
    Ignore(columns->difference, 3, columns);
    Ignore(columns->difference_sigma, 3, columns);
    Ignore(columns->covariance, 6, columns);
  }
  if (mapping.targets.empty()) return;
  Ignore(columns->position, 3, columns);
  Ignore(columns->target, 1, columns);
}

// Those that the mapping states hold for all headers, those of the job for the
// ones that the mapping names.
void SetDefaultUnits(const DataFormat& format, DatasetColumns* columns) {
  const ColumnMapping& mapping = format.columns;
  for (ColumnSpec& spec : columns->specs) {
    const bool is_angle = spec.type == ColumnType::kAngle;
    if (!is_angle && spec.type != ColumnType::kLength) continue;
    const Unit* const stated =
        is_angle ? mapping.angle_unit : mapping.length_unit;
    const Unit* const of_job =
        is_angle ? format.angle_unit : format.length_unit;
    spec.default_unit = stated != nullptr     ? stated
                        : spec.mapped.empty() ? nullptr
                                              : of_job;
  }
  if (mapping.rotation_unit == nullptr) return;
  for (const int first : {columns->angles, columns->vector,
                          columns->angle_sigma, columns->turn_sigma}) {
    for (int i = first; i < first + 3; ++i) {
      columns->specs[i].default_unit = mapping.rotation_unit;
    }
  }
}

int CountHas(const TableHeader& header, int first, int count) {
  int found = 0;
  for (int i = first; i < first + count; ++i) found += header.Has(i) ? 1 : 0;
  return found;
}

// The checks of a header, in the order that people read it in.
class HeaderCheck {
 public:
  HeaderCheck(const DatasetColumns& columns, const DataFormat& format,
              const Arm& arm, const TableHeader& header)
      : columns_(columns), format_(format), arm_(arm), header_(header) {}

  MeasuredGroups Check() {
    CheckPosition();
    CheckOrientation();
    CheckReferences();
    CheckDifference();
    CheckSomethingIsMeasured();
    if (format_.is_inverse && !(groups_.position && groups_.orientation())) {
      header_.Fail(
          "inverse poses need columns of a position and of an orientation");
    }
    CheckTarget();
    return groups_;
  }

 private:
  const ColumnSpec& Spec(int i) const { return columns_.specs[i]; }

  [[noreturn]] void FailMissing(int i, const std::string& why = "") const {
    header_.Fail("column is missing, expected " + Spellings(Spec(i)) + why,
                 FirstName(Spec(i)));
  }

  // Fails unless all of the columns are there, or none of them.
  bool HasAll(int first, int count) const {
    const int found = CountHas(header_, first, count);
    for (int i = first; i < first + count; ++i) {
      if (found > 0 && !header_.Has(i)) FailMissing(i);
    }
    return found > 0;
  }

  // Sigmas are optional, but then of every axis that is measured.
  void CheckSigmas(int sigma, int value, bool measures_all) const {
    if (CountHas(header_, sigma, 3) == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_measured = measures_all || header_.Has(value + axis);
      if (is_measured && !header_.Has(sigma + axis)) FailMissing(sigma + axis);
      if (is_measured || !header_.Has(sigma + axis)) continue;
      FailMissing(value + axis, " beside " + FirstName(Spec(sigma + axis)));
    }
  }

  void CheckPosition() {
    const bool has_targets = !columns_.target_positions.empty();
    groups_.position =
        has_targets || CountHas(header_, columns_.position, 3) > 0;
    CheckSigmas(columns_.position_sigma, columns_.position, has_targets);
    groups_.covariance = HasAll(columns_.covariance, 6);
    if (!groups_.covariance) return;
    if (!has_targets) {
      for (int axis = 0; axis < 3; ++axis) {
        if (header_.Has(columns_.position + axis)) continue;
        FailMissing(columns_.position + axis, " beside its covariance");
      }
    }
    if (CountHas(header_, columns_.position_sigma, 3) > 0) {
      header_.Fail("found beside the covariance, expected one of both",
                   FirstName(Spec(columns_.position_sigma)));
    }
  }

  void CheckOrientation() {
    groups_.angles = HasAll(columns_.angles, 3);
    groups_.vector = HasAll(columns_.vector, 3);
    groups_.quaternion = HasAll(columns_.quaternion, 4);
    groups_.matrix = HasAll(columns_.matrix, 9);
    if (groups_.angles + groups_.vector + groups_.quaternion + groups_.matrix >
        1) {
      header_.Fail(
          "the orientation is there more than once, expected one of rx ry rz, "
          "wx wy wz, qw qx qy qz and r11 r12 ... r33");
    }
    if (groups_.angles && !format_.rotation) {
      header_.Fail(
          "the convention of the angles is not stated, expected `rotation: "
          "NAME` in the job's `data`, one of intrinsic_xyz, extrinsic_xyz (or "
          "xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz), "
          "rotation_vector; or `rotation: ignore`",
          FirstName(Spec(columns_.angles)));
    }
    const bool has_angle_sigmas = HasAll(columns_.angle_sigma, 3);
    const bool has_rotation_sigmas = HasAll(columns_.turn_sigma, 3);
    if (has_angle_sigmas && !groups_.angles) FailMissing(columns_.angles);
    if (has_rotation_sigmas && !groups_.orientation()) {
      FailMissing(columns_.vector);
    }
    if (has_angle_sigmas && has_rotation_sigmas) {
      header_.Fail("found beside std_rx, expected one of both",
                   FirstName(Spec(columns_.turn_sigma)));
    }
  }

  void CheckReferences() {
    const int parts = CountPointParts();
    if (parts > 0 && !format_.point.empty()) FailTwice(columns_.point[0]);
    const bool has_point = parts > 0 || !format_.point.empty();
    groups_.distance = header_.Has(columns_.distance);
    groups_.fixed_point = has_point && !groups_.distance;
    if (groups_.distance && !has_point) {
      FailMissing(columns_.point[0], ": the point it is measured from");
    }
    if (header_.Has(columns_.distance_sigma) && !groups_.distance) {
      FailMissing(columns_.distance);
    }
    const bool has_plane = header_.Has(columns_.plane);
    if (has_plane && !format_.plane.empty()) FailTwice(columns_.plane);
    groups_.plane = has_plane || !format_.plane.empty();
  }

  int CountPointParts() const {
    int parts = 0;
    for (const int part : columns_.point) parts += header_.Has(part) ? 1 : 0;
    return parts;
  }

  [[noreturn]] void FailTwice(int i) const {
    const std::string name = FirstName(Spec(i));
    header_.Fail(
        "a column of the file, and named for all of its rows too, "
        "expected one of both",
        name);
  }

  void CheckDifference() {
    groups_.difference = CountHas(header_, columns_.difference, 3) > 0;
    CheckSigmas(columns_.difference_sigma, columns_.difference, false);
    if (groups_.difference && !header_.Has(columns_.from)) {
      FailMissing(columns_.from, ": the row that the difference is to");
    }
    if (!groups_.difference && header_.Has(columns_.from)) {
      FailMissing(columns_.difference, " beside from");
    }
  }

  void CheckSomethingIsMeasured() const {
    if (groups_.position || groups_.orientation() || groups_.distance ||
        groups_.fixed_point || groups_.plane || groups_.difference) {
      return;
    }
    header_.Fail(
        "no column holds a measurement, expected some of x_mm y_mm z_mm, "
        "rx_deg "
        "ry_deg rz_deg, wx_deg wy_deg wz_deg, qw qx qy qz, r11 r12 ... r33, "
        "distance_mm, point, "
        "plane, dx_mm dy_mm dz_mm (or _m, _rad)");
  }

  void CheckTarget() const {
    const bool has_column = header_.Has(columns_.target);
    if (has_column && !format_.target.empty()) FailTwice(columns_.target);
    if (!columns_.target_positions.empty()) {
      if (groups_.orientation()) {
        header_.Fail(
            "orientations beside positions of several targets in one row, "
            "expected rows of one target, or `rotation: ignore`");
      }
      return;
    }
    if (has_column || !format_.target.empty() || arm_.num_targets() == 1) {
      return;
    }
    std::vector<std::string> names;
    for (const Target& target : arm_.targets) names.push_back(target.name);
    header_.Fail("column is missing: arm " + Quote(arm_.name) +
                     " has the targets " + JoinNames(names) +
                     ", expected a column that names one of them, or `target: "
                     "NAME` in the job's `data`",
                 "target");
  }

  const DatasetColumns& columns_;
  const DataFormat& format_;
  const Arm& arm_;
  const TableHeader& header_;
  MeasuredGroups groups_;
};

}  // namespace

DatasetColumns MakeDatasetColumns(const Arm& arm, const DataFormat& format) {
  const ColumnMapping& mapping = format.columns;
  DatasetColumns columns;
  std::vector<ColumnSpec>* specs = &columns.specs;
  *specs = JointColumns(arm);
  for (std::size_t j = 0; j < mapping.joints.size(); ++j) {
    (*specs)[j].mapped = mapping.joints[j];
  }
  AddPositions(mapping, &columns);
  AddOrientations(mapping, &columns);
  const auto one = [](const std::string& header) {
    return header.empty() ? Headers() : Headers{header};
  };
  columns.distance = Add({"distance"}, ColumnType::kLength, CellRule::kPositive,
                         one(mapping.distance), specs);
  columns.distance_sigma =
      Add({"std_distance"}, ColumnType::kLength, CellRule::kPositive,
          one(mapping.std_distance), specs);
  columns.point.push_back(
      AddText("point", mapping.point.empty() ? "" : mapping.point[0], specs));
  for (std::size_t i = 1; i < mapping.point.size(); ++i) {
    columns.point.push_back(AddText("point", mapping.point[i], specs));
  }
  columns.plane = AddText("plane", mapping.plane, specs);
  columns.difference = Add({"dx", "dy", "dz"}, ColumnType::kLength,
                           CellRule::kMeasured, {}, specs);
  columns.difference_sigma =
      Add({"std_dx", "std_dy", "std_dz"}, ColumnType::kLength,
          CellRule::kPositive, {}, specs);
  columns.from = AddText("from", "", specs);
  columns.target = AddText("target", mapping.target, specs);
  columns.set = AddText("set", mapping.set, specs);
  columns.station = AddText("station", mapping.station, specs);
  columns.num_covariates = static_cast<int>(mapping.covariates.size());
  columns.covariates = Add(mapping.covariates, ColumnType::kPlain,
                           CellRule::kRequired, mapping.covariates, specs);
  columns.covariance =
      Add({"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"},
          ColumnType::kSquareLength, CellRule::kMeasured, {}, specs);
  for (const auto& [name, headers] : mapping.targets) {
    columns.target_positions.push_back(Add({"x", "y", "z"}, ColumnType::kLength,
                                           CellRule::kMeasured, headers,
                                           specs));
  }
  IgnoreOthers(format, &columns);
  SetDefaultUnits(format, &columns);
  return columns;
}

MeasuredGroups CheckColumns(const DatasetColumns& columns,
                            const DataFormat& format, const Arm& arm,
                            const TableHeader& header) {
  return HeaderCheck(columns, format, arm, header).Check();
}

}  // namespace alidade::internal
