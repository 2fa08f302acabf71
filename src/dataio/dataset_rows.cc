#include "src/dataio/dataset_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "alidade/rotation.h"
#include "src/common/constants.h"
#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/dataio/covariance.h"
#include "src/dataio/inverse_pose.h"
#include "src/dataio/row_orientation.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

// Two of the angles turn about one axis there.
constexpr char kGimbalLock[] =
    "the angles are in gimbal lock here: their standard deviations leave a "
    "direction without noise, expected std_wx_deg std_wy_deg std_wz_deg (about "
    "the instrument's axes) instead";

int FindOrAddPoint(const std::string& name, References* references) {
  const int found = references->FindPoint(name);
  if (found >= 0) return found;
  references->points.push_back({name, Eigen::Vector3d::Zero(), false});
  return references->num_points() - 1;
}

int FindOrAddPlane(const std::string& name, References* references) {
  const int found = references->FindPlane(name);
  if (found >= 0) return found;
  references->planes.emplace_back().name = name;
  return references->num_planes() - 1;
}

}  // namespace

DatasetRows::DatasetRows(const DataTable& table, const DatasetColumns& columns,
                         const MeasuredGroups& groups, const DataFile& file)
    : header_(table.header()),
      table_(table),
      columns_(columns),
      arm_(file.arm),
      format_(file.format),
      groups_(groups),
      rotation_sigma_(format_.rotation_sigma > 0.0
                          ? format_.rotation_sigma
                          : DefaultRotationSigma(format_.sigma)),
      motors_(NumMotors(arm_), table.num_rows()),
      lines_(table.num_rows()),
      covariates_(columns.num_covariates,
                  columns.num_covariates > 0 ? table.num_rows() : 0),
      sets_(header_.Has(columns.set) ? table.num_rows() : 0),
      stations_(header_.Has(columns.station) || !format_.stations.empty()
                    ? table.num_rows()
                    : 0) {
  const auto num_targets =
      static_cast<Eigen::Index>(columns.target_positions.size());
  if (groups_.position || groups_.orientation()) {
    AddGroup(groups_.orientation() ? MeasurementKind::kPose
                                   : MeasurementKind::kPosition,
             std::max<Eigen::Index>(1, num_targets), columns.position_sigma,
             num_targets > 0 ? &DatasetRows::ReadTargetPositions
                             : &DatasetRows::ReadPositions);
  }
  if (groups_.distance) {
    AddGroup(MeasurementKind::kDistance, 1, columns.distance_sigma,
             &DatasetRows::ReadDistance);
  }
  if (groups_.fixed_point) {
    AddGroup(MeasurementKind::kFixedPoint, 1, -1, &DatasetRows::ReadFixedPoint);
  }
  if (groups_.plane) {
    AddGroup(MeasurementKind::kPlane, 1, -1, &DatasetRows::ReadPlane);
  }
  if (groups_.difference) {
    AddGroup(MeasurementKind::kDifference, 1, columns.difference_sigma,
             &DatasetRows::ReadDifference);
  }
  if (groups_.distance || groups_.fixed_point) points_.resize(lines_.size());
  if (groups_.plane) planes_.resize(lines_.size());
  if (groups_.difference) {
    links_.resize(lines_.size());
    link_columns_.resize(lines_.size());
  }
}

// `sigma`: the first column of standard deviations of the group's lengths, -1
// where it has none.
void DatasetRows::AddGroup(MeasurementKind kind, Eigen::Index per_row,
                           int sigma, Reader read) {
  ObservationTable::Shape shape;
  shape.kind = kind;
  shape.num_rows = table_.num_rows();
  shape.per_row = per_row;
  shape.default_sigmas.setConstant(RowsOf(kind), format_.sigma);
  for (int axis = 0; axis < 3 && sigma >= 0; ++axis) {
    const bool is_of_group = axis == 0 || RowsOf(kind) > 1;
    shape.states_sigmas |= is_of_group && header_.Has(sigma + axis);
  }
  shape.states_targets = header_.Has(columns_.target) ||
                         !format_.target.empty() ||
                         !columns_.target_positions.empty();
  if (HoldsPosition(kind)) {
    const bool has_angle_sigmas = header_.Has(columns_.angle_sigma);
    shape.has_whiteners =
        groups_.covariance || has_angle_sigmas || format_.is_inverse;
    shape.states_sigmas |=
        shape.has_whiteners || header_.Has(columns_.turn_sigma);
  }
  if (kind == MeasurementKind::kPose) {
    shape.default_sigmas.tail(3).setConstant(rotation_sigma_);
  }
  tables_.emplace_back(shape);
  readers_.push_back(read);
}

void DatasetRows::Read(const TableRow& row) {
  const std::int64_t i = row.index();
  lines_[i] = row.line();
  if (!sets_.empty()) sets_[i] = row.Text(columns_.set);
  if (!stations_.empty()) stations_[i] = StationOf(row);
  for (int k = 0; k < columns_.num_covariates; ++k) {
    covariates_.map()(k, i) = row.Number(columns_.covariates + k);
  }
  double* const motors = motors_.map().col(i).data();
  const Eigen::Index num_motors = motors_.map().rows();
  for (int j = 0; j < num_motors; ++j) motors[j] = row.Number(j);
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    (this->*readers_[k])(row, &tables_[k]);
  }
}

std::string DatasetRows::StationOf(const TableRow& row) const {
  if (format_.stations.empty()) return std::string(row.Text(columns_.station));
  for (const auto& [name, lines] : format_.stations) {
    if (row.line() >= lines.first && row.line() <= lines.second) return name;
  }
  row.Fail(columns_.station,
           "line " + std::to_string(row.line()) +
               " belongs to none of `stations`: expected each line in one");
}

// A row whose orientation was not measured is one of position.
void DatasetRows::ReadPositions(const TableRow& row, ObservationTable* table) {
  StatedObservation stated;
  const int count = ReadPosition(row, columns_.position, &stated);
  const bool has_orientation =
      groups_.orientation() && HasOrientation(row, columns_, groups_);
  if (count == 0 && !has_orientation) return;
  stated.target = ReadTarget(row);
  if (has_orientation) ReadOrientation(row, &stated);
  if (format_.is_inverse && !(has_orientation && InvertPose(&stated))) {
    row.Fail(columns_.position,
             "inverse poses need position and orientation whole");
  }
  table->Set(
      row.index(),
      has_orientation ? MeasurementKind::kPose : MeasurementKind::kPosition,
      stated);
}

void DatasetRows::ReadTargetPositions(const TableRow& row,
                                      ObservationTable* table) {
  const auto num_targets =
      static_cast<std::int64_t>(columns_.target_positions.size());
  for (std::int64_t t = 0; t < num_targets; ++t) {
    const int first = columns_.target_positions[t];
    StatedObservation stated;
    if (ReadPosition(row, first, &stated) == 0) continue;
    stated.target = FindTarget(format_.columns.targets[t].first, first, row);
    table->Set(row.index() * num_targets + t, MeasurementKind::kPosition,
               stated);
  }
}

void DatasetRows::ReadDistance(const TableRow& row, ObservationTable* table) {
  StatedObservation stated;
  stated.measured[0] = row.Number(columns_.distance);
  if (std::isnan(stated.measured[0])) return;
  points_[row.index()] = ReadPoint(row);
  if (points_[row.index()].empty()) {
    row.Fail(columns_.point[0],
             "expected the name of the point that the distance is "
             "measured from, found nothing");
  }
  stated.sigmas[0] = SigmaOr(row, columns_.distance_sigma, format_.sigma);
  stated.target = ReadTarget(row);
  table->Set(row.index(), MeasurementKind::kDistance, stated);
}

void DatasetRows::ReadFixedPoint(const TableRow& row, ObservationTable* table) {
  points_[row.index()] = ReadPoint(row);
  if (points_[row.index()].empty()) return;
  StatedObservation stated;
  stated.sigmas.fill(format_.sigma);
  stated.target = ReadTarget(row);
  table->Set(row.index(), MeasurementKind::kFixedPoint, stated);
}

void DatasetRows::ReadPlane(const TableRow& row, ObservationTable* table) {
  std::string& name = planes_[row.index()];
  name = format_.plane.empty() ? row.Text(columns_.plane) : format_.plane;
  if (name.empty()) return;
  StatedObservation stated;
  stated.sigmas.fill(format_.sigma);
  stated.target = ReadTarget(row);
  table->Set(row.index(), MeasurementKind::kPlane, stated);
}

void DatasetRows::ReadDifference(const TableRow& row, ObservationTable* table) {
  StatedObservation stated;
  if (ReadTriple(row, columns_.difference, columns_.difference_sigma,
                 &stated) == 0) {
    return;
  }
  const std::string_view text = row.Text(columns_.from);
  const std::optional<int> from = ParseWhole<int>(text);
  if (from < 1 || from == row.index() + 1) {
    row.Fail(columns_.from,
             "expected the number of another data row, counted from 1, "
             "found " +
                 (text.empty() ? "nothing" : Quote(text)));
  }
  links_[row.index()] = *from;
  link_columns_[row.index()] = row.Location(columns_.from).column;
  stated.target = ReadTarget(row);
  table->Set(row.index(), MeasurementKind::kDifference, stated);
}

// Three numbers and their sigmas; how many of them were measured.
int DatasetRows::ReadTriple(const TableRow& row, int first, int sigma,
                            StatedObservation* stated) const {
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double number = row.Number(first + axis);
    stated->sigmas[axis] = kInfinity;
    if (std::isnan(number)) continue;
    stated->measured[axis] = number;
    stated->sigmas[axis] = SigmaOr(row, sigma + axis, format_.sigma);
    ++count;
  }
  return count;
}

int DatasetRows::ReadPosition(const TableRow& row, int first,
                              StatedObservation* stated) const {
  const int count = ReadTriple(row, first, columns_.position_sigma, stated);
  if (!groups_.covariance || count == 0) return count;
  std::vector<bool> is_measured(3);
  Eigen::Matrix3d covariance;
  int spec = columns_.covariance;
  for (int i = 0; i < 3; ++i) {
    is_measured[i] = std::isfinite(stated->sigmas[i]);
    for (int j = i; j < 3; ++j, ++spec) {
      const bool is_needed = is_measured[i] && std::isfinite(stated->sigmas[j]);
      covariance(i, j) = is_needed ? SigmaOr(row, spec, 0.0) : 0.0;
      covariance(j, i) = covariance(i, j);
    }
  }
  const std::optional<Noise> noise = CorrelatedNoise(covariance, is_measured);
  if (!noise) {
    row.Fail(columns_.covariance,
             "the covariance is not positive definite, expected "
             "variances above zero and correlations between -1 and 1");
  }
  std::copy_n(noise->sigmas.data(), 3, stated->sigmas.begin());
  stated->whitener = noise->whitener;
  return count;
}

void DatasetRows::ReadOrientation(const TableRow& row,
                                  StatedObservation* stated) const {
  if (groups_.angles) RefuseLargeAngles(row, header_, columns_.angles);
  const Eigen::Vector3d vector = VectorFromRotation(
      ReadRotation(row, columns_, groups_, format_.rotation));
  std::copy_n(vector.data(), 3, stated->measured.begin() + 3);
  Eigen::Map<Eigen::Vector3d> sigmas(stated->sigmas.data() + 3);
  const bool has_angle_sigmas = header_.Has(columns_.angle_sigma);
  const int first =
      has_angle_sigmas ? columns_.angle_sigma : columns_.turn_sigma;
  for (int i = 0; i < 3; ++i) {
    sigmas[i] = SigmaOr(row, first + i, rotation_sigma_);
  }
  Noise noise = IndependentNoise(sigmas);
  if (has_angle_sigmas) {
    const Eigen::Matrix3d turns =
        TurningAxes(*format_.rotation, VectorOf(row, columns_.angles)) *
        sigmas.asDiagonal();
    const std::optional<Noise> correlated =
        CorrelatedNoise(turns * turns.transpose(), {true, true, true});
    if (!correlated) row.Fail(columns_.angle_sigma, kGimbalLock);
    noise = *correlated;
    sigmas = noise.sigmas;
  } else if (stated->whitener.size() == 0) {
    return;
  }
  const Eigen::Map<const Eigen::Vector3d> position(stated->sigmas.data());
  stated->whitener = StackNoise({position, stated->whitener}, noise).whitener;
}

double DatasetRows::SigmaOr(const TableRow& row, int spec,
                            double otherwise) const {
  if (!header_.Has(spec)) return otherwise;
  if (std::isnan(row.Number(spec))) {
    row.Fail(spec, DescribeBadNumber(row.Text(spec), ""));
  }
  return row.Number(spec);
}

int DatasetRows::ReadTarget(const TableRow& row) const {
  if (!format_.target.empty()) return FindTarget(format_.target, -1, row);
  if (!header_.Has(columns_.target)) return 0;
  return FindTarget(row.Text(columns_.target), columns_.target, row);
}

int DatasetRows::FindTarget(std::string_view name, int spec,
                            const TableRow& row) const {
  for (int i = 0; i < arm_.num_targets(); ++i) {
    if (!name.empty() && arm_.targets[i].name == name) return i;
  }
  std::vector<std::string> names;
  for (const Target& target : arm_.targets) {
    if (!target.name.empty()) names.push_back(target.name);
  }
  const std::string message =
      names.empty()
          ? "unknown target " + Quote(name) + ": arm " + Quote(arm_.name) +
                " names none, expected `targets` in its file"
          : UnknownName("target", name, names);
  if (spec >= 0) row.Fail(spec, message);
  throw InputError({header_.path(), 0, 0, "target"}, message);
}

// Empty where the row names none.
std::string DatasetRows::ReadPoint(const TableRow& row) const {
  if (!format_.point.empty()) return format_.point;
  std::string name;
  int empty = -1;
  for (const int part : columns_.point) {
    const std::string_view text = row.Text(part);
    if (text.empty()) empty = part;
    name += (part == columns_.point[0] ? "" : "/") + std::string(text);
  }
  if (name.size() + 1 == columns_.point.size()) return "";
  if (empty >= 0) {
    row.Fail(empty, "expected a part of the point's name, found nothing");
  }
  return name;
}

// Rows that hold a measurement or that a difference is to.
std::vector<bool> DatasetRows::FindPoses() const {
  const auto size = static_cast<std::int64_t>(lines_.size());
  std::vector<bool> is_pose(lines_.size());
  for (std::int64_t i = 0; i < size; ++i) {
    is_pose[i] = std::any_of(
        tables_.begin(), tables_.end(),
        [i](const ObservationTable& table) { return table.IsRowMeasured(i); });
  }
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(links_.size()); ++i) {
    const int to = links_[i];
    if (to == 0) continue;
    if (to > size || lines_[to - 1] == 0) {
      throw InputError({header_.path(), lines_[i], link_columns_[i],
                        header_.NameOf(columns_.from)},
                       to <= size ? "data row " + std::to_string(to) +
                                        " is left out by `where` or `exclude`, "
                                        "expected one that is kept"
                                  : "expected a data row from 1 to " +
                                        std::to_string(size) + ", found " +
                                        std::to_string(to));
    }
    is_pose[to - 1] = true;
  }
  return is_pose;
}

std::vector<ObservationBlock> DatasetRows::MakeBlocks(RowNumbers numbers,
                                                      Eigen::Index num_poses,
                                                      References* references) {
  // By the row that each kind first comes in.
  std::vector<std::pair<Eigen::Index, ObservationBlock>> blocks;
  for (ObservationTable& table : tables_) {
    const bool has_point = table.kind() == MeasurementKind::kDistance ||
                           table.kind() == MeasurementKind::kFixedPoint;
    numbers.references.clear();
    for (const std::string& name : has_point ? points_ : planes_) {
      if (!HasReference(table.kind())) break;
      numbers.references.push_back(name.empty() ? -1
                                   : has_point
                                       ? FindOrAddPoint(name, references)
                                       : FindOrAddPlane(name, references));
    }
    numbers.seconds.clear();
    for (const int to : links_) {
      if (!HasSecond(table.kind())) break;
      numbers.seconds.push_back(to == 0 ? -1
                                : numbers.poses.empty()
                                    ? to - 1
                                    : numbers.poses[to - 1]);
    }
    std::vector<MeasurementKind> kinds = {table.kind()};
    if (table.kind() == MeasurementKind::kPose) {
      kinds.push_back(MeasurementKind::kPosition);
    }
    for (const MeasurementKind kind : kinds) {
      const std::optional<Eigen::Index> first = table.FirstRow(kind);
      if (!first) continue;
      blocks.emplace_back(*first, table.Take(kind, numbers, num_poses));
    }
  }
  std::stable_sort(
      blocks.begin(), blocks.end(),
      [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ObservationBlock> sorted;
  for (auto& [first, block] : blocks) sorted.push_back(std::move(block));
  return sorted;
}

LoadedData DatasetRows::Finish(References* references) {
  const bool is_any_kept =
      std::any_of(lines_.begin(), lines_.end(), [](int line) { return line; });
  if (!is_any_kept) {
    table_.FailAtEnd(
        lines_.empty()
            ? "no rows after the header, expected one for every pose"
            : "`where` and `exclude` leave no row, expected a text that is in "
              "its column");
  }
  LoadedData loaded;
  Dataset& data = loaded.data;
  const std::vector<bool> is_pose = FindPoses();
  // Lists of poses are made where they say something.
  RowNumbers numbers;
  KeptColumns kept;
  if (std::find(is_pose.begin(), is_pose.end(), false) != is_pose.end()) {
    numbers.poses.assign(lines_.size(), -1);
    kept.emplace();
  }
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (is_pose[i]) {
      data.sources.push_back({0, lines_[i]});
      if (!sets_.empty()) loaded.sets.push_back(std::move(sets_[i]));
      if (!stations_.empty()) loaded.stations.push_back(stations_[i]);
      if (!kept) continue;
      numbers.poses[i] = static_cast<int>(kept->size());
      kept->push_back(static_cast<Eigen::Index>(i));
    } else if (lines_[i] > 0) {
      loaded.rejected.push_back(
          {header_.path(), lines_[i], "nothing was measured"});
    }
  }
  if (kept && kept->empty()) {
    table_.FailAtEnd(
        "no row holds a measurement, expected a number in one of them");
  }
  data.name = header_.path();
  data.files = {header_.path()};
  data.joint_values =
      JointsFromMotors(arm_, KeepColumns(kept, NumMotors(arm_), &motors_));
  if (columns_.num_covariates > 0) {
    data.covariate_names = format_.columns.covariates;
    data.covariates = KeepColumns(kept, columns_.num_covariates, &covariates_);
  }
  data.blocks = MakeBlocks(std::move(numbers), data.num_poses(), references);
  return loaded;
}

}  // namespace alidade::internal
