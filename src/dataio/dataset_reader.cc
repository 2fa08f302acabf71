#include "src/dataio/dataset_reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/common/names.h"
#include "src/common/numbers.h"
#include "src/common/text.h"
#include "src/dataio/orientation_cells.h"
#include "src/dataio/plain_csv.h"
#include "src/dataio/plain_rows.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Two of the angles turn about one axis there.
constexpr char kGimbalLock[] =
    "the angles are in gimbal lock here: their standard deviations leave a "
    "direction without noise, expected std_wx_deg std_wy_deg std_wz_deg (about "
    "the instrument's axes) instead";

}  // namespace

DatasetReader::DatasetReader(MappedFile file, const Arm& arm,
                             const DataFormat& format, References* references)
    : arm_(arm),
      format_(format),
      references_(references),
      columns_(MakeDatasetColumns(arm, format)),
      rows_(std::move(file), arm, columns_.specs, format.ignore_others,
            format.where),
      groups_(CheckColumns(columns_, format, arm, rows_)),
      rotation_sigma_(format.rotation_sigma > 0.0
                          ? format.rotation_sigma
                          : DefaultRotationSigma(format.sigma)) {}

std::optional<PlainLayout> DatasetReader::Layout() const {
  return MakePlainLayout({columns_, groups_, rows_}, arm_, format_,
                         rotation_sigma_);
}

LoadedData DatasetReader::Read(const ReadOptions& options) {
  if (!options.is_careful) {
    if (const std::optional<PlainLayout> layout = Layout()) {
      std::optional<LoadedData> loaded =
          ReadPlainCsv(rows_, *layout, arm_, options);
      if (loaded) return *std::move(loaded);
    }
  }
  return ReadRows();
}

LoadedData DatasetReader::ReadRows() {
  while (rows_.Next()) ReadRow();
  if (read_.empty()) {
    rows_.Fail(rows_.row() == 0
                   ? "no rows behind the header, expected one for every pose"
                   : "`where` leaves no row, expected a text that is in its "
                     "column");
  }
  LoadedData loaded;
  const std::vector<int> pose_of_row = KeepRows(&loaded);
  Connect(pose_of_row);
  Dataset& data = loaded.data;
  data.name = rows_.path();
  data.files = {rows_.path()};
  const int n = arm_.num_joints();
  const Eigen::Map<const Eigen::MatrixXd> motors(
      motors_.data(), n, static_cast<Eigen::Index>(read_.size()));
  Eigen::MatrixXd kept(n, static_cast<Eigen::Index>(data.sources.size()));
  for (std::size_t i = 0; i < read_.size(); ++i) {
    if (pose_of_row[i] < 0) continue;
    kept.col(pose_of_row[i]) = motors.col(static_cast<Eigen::Index>(i));
  }
  data.joint_values = JointsFromMotors(arm_, kept);
  data.blocks = MakeBlocks(observations_, data.num_poses());
  return loaded;
}

void DatasetReader::ReadRow() {
  Row row;
  row.number = rows_.row();
  row.line = rows_.line();
  row.set = rows_.Text(columns_.set);
  read_.push_back(std::move(row));
  for (int j = 0; j < arm_.num_joints(); ++j) {
    motors_.push_back(rows_.Number(j));
  }
  if (columns_.target_positions.empty()) {
    ReadPositions();
  } else {
    ReadTargetPositions();
  }
  if (groups_.distance) ReadDistance();
  if (groups_.fixed_point) ReadFixedPoint();
  if (groups_.plane) ReadPlane();
  if (groups_.difference) ReadDifference();
}

void DatasetReader::Add(MeasurementKind kind, int target, int reference,
                        const Observation::Rows& measured, const Noise& noise) {
  Observation observation;
  observation.kind = kind;
  observation.pose = static_cast<int>(read_.size()) - 1;
  observation.target = target;
  observation.reference = reference;
  observation.measured = measured;
  observation.sigmas = noise.sigmas;
  observation.whitener = noise.whitener;
  observations_.push_back(std::move(observation));
  read_.back().is_measured = true;
}

// A row whose orientation was not measured is one of position.
void DatasetReader::ReadPositions() {
  const Triple position = ReadTriple(columns_.position);
  const bool has_orientation =
      groups_.quaternion ? HasOrientation(columns_.quaternion, 4)
      : groups_.vector   ? HasOrientation(columns_.vector, 3)
                         : HasOrientation(columns_.angles, 3);
  if (!has_orientation) {
    if (position.count == 0) return;
    Add(MeasurementKind::kPosition, ReadTarget(), 0, position.value,
        PositionNoise(position));
    return;
  }
  Observation::Rows measured(6);
  measured.head<3>() = position.value;
  measured.tail<3>() = MeasuredVector(ReadOrientation());
  Add(MeasurementKind::kPose, ReadTarget(), 0, measured,
      StackNoise(PositionNoise(position), OrientationNoise()));
}

void DatasetReader::ReadTargetPositions() {
  for (std::size_t i = 0; i < columns_.target_positions.size(); ++i) {
    const int first = columns_.target_positions[i];
    const Triple position = ReadTriple(first);
    if (position.count == 0) continue;
    const int target = FindTarget(format_.columns.targets[i].first, first);
    Add(MeasurementKind::kPosition, target, 0, position.value,
        PositionNoise(position));
  }
}

void DatasetReader::ReadDistance() {
  if (std::isnan(rows_.Number(columns_.distance))) return;
  const std::optional<int> point = ReadPoint();
  if (!point) {
    rows_.FailCell(columns_.point[0],
                   "expected the name of the point that the distance is "
                   "measured from, found nothing");
  }
  const double sigma = SigmaOr(columns_.distance_sigma, format_.sigma);
  Add(MeasurementKind::kDistance, ReadTarget(), *point,
      Observation::Rows::Constant(1, rows_.Number(columns_.distance)),
      IndependentNoise(Eigen::VectorXd::Constant(1, sigma)));
}

void DatasetReader::ReadFixedPoint() {
  const std::optional<int> point = ReadPoint();
  if (!point) return;
  Add(MeasurementKind::kFixedPoint, ReadTarget(), *point,
      Observation::Rows::Zero(3),
      IndependentNoise(Eigen::VectorXd::Constant(3, format_.sigma)));
}

void DatasetReader::ReadPlane() {
  const std::string name = format_.plane.empty()
                               ? std::string(rows_.Text(columns_.plane))
                               : format_.plane;
  if (name.empty()) return;
  Add(MeasurementKind::kPlane, ReadTarget(), FindPlane(name),
      Observation::Rows::Zero(1),
      IndependentNoise(Eigen::VectorXd::Constant(1, format_.sigma)));
}

void DatasetReader::ReadDifference() {
  const Triple difference = ReadTriple(columns_.difference);
  if (difference.count == 0) return;
  const std::string_view text = rows_.Text(columns_.from);
  const std::optional<int> from = ParseWhole<int>(text);
  if (from < 1 || from == rows_.row()) {
    rows_.FailCell(columns_.from,
                   "expected the number of another data row, counted from 1, "
                   "found " +
                       (text.empty() ? "nothing" : Quote(text)));
  }
  Add(MeasurementKind::kDifference, ReadTarget(), 0, difference.value,
      TripleNoise(difference, columns_.difference_sigma));
  links_.push_back(
      {observations_.size() - 1, *from, rows_.CellLocation(columns_.from)});
}

DatasetReader::Triple DatasetReader::ReadTriple(int first) const {
  Triple triple;
  for (int axis = 0; axis < 3; ++axis) {
    const double number = rows_.Number(first + axis);
    if (std::isnan(number)) continue;
    triple.value[axis] = number;
    triple.is_measured[axis] = true;
    ++triple.count;
  }
  return triple;
}

// All of a row's numbers or none of them.
bool DatasetReader::HasOrientation(int first, int count) const {
  int found = 0;
  for (int i = first; i < first + count; ++i) {
    if (!std::isnan(rows_.Number(i))) ++found;
  }
  if (found == 0 || found == count) return found > 0;
  for (int i = first; i < first + count; ++i) {
    if (!std::isnan(rows_.Number(i))) continue;
    rows_.FailCell(i,
                   "an orientation is measured as a whole: expected a "
                   "number here, or none in its other cells, found " +
                       (rows_.Text(i).empty() ? std::string("nothing")
                                              : Quote(rows_.Text(i))));
  }
  return false;
}

Eigen::Matrix3d DatasetReader::ReadOrientation() const {
  if (groups_.quaternion) return ReadQuaternion();
  if (groups_.vector) {
    return RotationOfVector(ReadTriple(columns_.vector).value);
  }
  return RotationOf(*format_.rotation, ReadTriple(columns_.angles).value);
}

Eigen::Matrix3d DatasetReader::ReadQuaternion() const {
  const int first = columns_.quaternion;
  const Eigen::Vector4d wxyz(rows_.Number(first), rows_.Number(first + 1),
                             rows_.Number(first + 2), rows_.Number(first + 3));
  const std::optional<Eigen::Matrix3d> rotation = RotationOfQuaternion(wxyz);
  if (!rotation) {
    const Eigen::Quaterniond quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    rows_.FailCell(first, "the quaternion's norm is " +
                              ShortestNumber(quaternion.norm()) +
                              ", expected 1 to within 0.001: are its columns "
                              "w, x, y, z?");
  }
  return *rotation;
}

double DatasetReader::SigmaOr(int spec, double otherwise) const {
  if (!rows_.Has(spec)) return otherwise;
  if (std::isnan(rows_.Number(spec))) {
    rows_.FailCell(spec, DescribeBadNumber(rows_.Text(spec), ""));
  }
  return rows_.Number(spec);
}

Noise DatasetReader::TripleNoise(const Triple& triple, int sigma) const {
  Eigen::Vector3d sigmas = Eigen::Vector3d::Constant(kInfinity);
  for (int axis = 0; axis < 3; ++axis) {
    if (!triple.is_measured[axis]) continue;
    sigmas[axis] = SigmaOr(sigma + axis, format_.sigma);
  }
  return IndependentNoise(sigmas);
}

Noise DatasetReader::PositionNoise(const Triple& position) const {
  if (!groups_.covariance || position.count == 0) {
    return TripleNoise(position, columns_.position_sigma);
  }
  Eigen::Matrix3d covariance;
  int spec = columns_.covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++spec) {
      const bool is_needed = position.is_measured[i] && position.is_measured[j];
      covariance(i, j) = is_needed ? SigmaOr(spec, 0.0) : 0.0;
      covariance(j, i) = covariance(i, j);
    }
  }
  const std::optional<Noise> noise =
      CorrelatedNoise(covariance, position.is_measured);
  if (!noise) {
    rows_.FailCell(columns_.covariance,
                   "the covariance is not positive definite, expected "
                   "variances above zero and correlations between -1 and 1");
  }
  return *noise;
}

Noise DatasetReader::OrientationNoise() const {
  Eigen::Vector3d sigmas = Eigen::Vector3d::Constant(rotation_sigma_);
  if (!rows_.Has(columns_.angle_sigma)) {
    for (int axis = 0; axis < 3; ++axis) {
      sigmas[axis] = SigmaOr(columns_.turn_sigma + axis, rotation_sigma_);
    }
    return IndependentNoise(sigmas);
  }
  for (int i = 0; i < 3; ++i) {
    sigmas[i] = SigmaOr(columns_.angle_sigma + i, rotation_sigma_);
  }
  const Eigen::Matrix3d turns =
      TurningAxes(*format_.rotation, ReadTriple(columns_.angles).value) *
      sigmas.asDiagonal();
  const std::optional<Noise> noise =
      CorrelatedNoise(turns * turns.transpose(), {true, true, true});
  if (!noise) rows_.FailCell(columns_.angle_sigma, kGimbalLock);
  return *noise;
}

int DatasetReader::ReadTarget() const {
  if (!format_.target.empty()) return FindTarget(format_.target, -1);
  if (!rows_.Has(columns_.target)) return 0;
  return FindTarget(rows_.Text(columns_.target), columns_.target);
}

int DatasetReader::FindTarget(std::string_view name, int spec) const {
  std::vector<std::string> names;
  for (int i = 0; i < arm_.num_targets(); ++i) {
    if (!name.empty() && arm_.targets[i].name == name) return i;
    if (!arm_.targets[i].name.empty()) names.push_back(arm_.targets[i].name);
  }
  const std::string message =
      names.empty()
          ? "unknown target " + Quote(name) + ": arm " + Quote(arm_.name) +
                " names none, expected `targets` in its file"
          : UnknownName("target", name, names);
  if (spec >= 0) rows_.FailCell(spec, message);
  throw InputError({rows_.path(), 0, 0, "target"}, message);
}

std::optional<int> DatasetReader::ReadPoint() {
  if (!format_.point.empty()) return FindPoint(format_.point);
  std::string name;
  int empty = -1;
  for (const int part : columns_.point) {
    const std::string_view text = rows_.Text(part);
    if (text.empty()) empty = part;
    name += (part == columns_.point[0] ? "" : "/") + std::string(text);
  }
  if (name.size() + 1 == columns_.point.size()) return std::nullopt;
  if (empty >= 0) {
    rows_.FailCell(empty, "expected a part of the point's name, found nothing");
  }
  return FindPoint(name);
}

int DatasetReader::FindPoint(const std::string& name) {
  const int found = references_->FindPoint(name);
  if (found >= 0) return found;
  references_->points.push_back({name, Eigen::Vector3d::Zero(), false});
  return references_->num_points() - 1;
}

int DatasetReader::FindPlane(const std::string& name) {
  const int found = references_->FindPlane(name);
  if (found >= 0) return found;
  ReferencePlane plane;
  plane.name = name;
  references_->planes.push_back(plane);
  return references_->num_planes() - 1;
}

std::size_t DatasetReader::FindRow(const Link& link) const {
  const auto found = std::lower_bound(
      read_.begin(), read_.end(), link.row,
      [](const Row& row, int number) { return row.number < number; });
  if (found == read_.end() || found->number != link.row) {
    const bool is_left_out = link.row <= rows_.row();
    throw InputError(link.named_at,
                     is_left_out
                         ? "data row " + std::to_string(link.row) +
                               " is left out by `where`, expected one that is "
                               "kept"
                         : "expected a data row from 1 to " +
                               std::to_string(rows_.row()) + ", found " +
                               std::to_string(link.row));
  }
  return found - read_.begin();
}

// Rows that hold a measurement or that a difference is to become poses; of the
// others, -1.
std::vector<int> DatasetReader::KeepRows(LoadedData* loaded) const {
  std::vector<bool> is_kept;
  for (const Row& row : read_) is_kept.push_back(row.is_measured);
  for (const Link& link : links_) is_kept[FindRow(link)] = true;
  std::vector<int> pose_of_row(read_.size(), -1);
  int num_poses = 0;
  for (std::size_t i = 0; i < read_.size(); ++i) {
    const Row& row = read_[i];
    if (!is_kept[i]) {
      loaded->rejected.push_back({rows_.path(), row.line, kNothingMeasured});
      continue;
    }
    pose_of_row[i] = num_poses++;
    loaded->data.sources.push_back({0, row.line});
    if (rows_.Has(columns_.set)) loaded->sets.push_back(row.set);
  }
  if (num_poses == 0) {
    rows_.Fail("no row holds a measurement, expected a number in one of them");
  }
  return pose_of_row;
}

void DatasetReader::Connect(const std::vector<int>& pose_of_row) {
  for (const Link& link : links_) {
    observations_[link.observation].second = pose_of_row[FindRow(link)];
  }
  for (Observation& observation : observations_) {
    observation.pose = pose_of_row[observation.pose];
  }
}

}  // namespace alidade::internal
