#include "src/initialization/frame_start.h"

#include <algorithm>
#include <cmath>

#include "src/common/svd.h"
#include "src/initialization/frame_models.h"
#include "src/kernel/robust_fit.h"

namespace alidade::internal {
namespace {

// Singular values below this part of the largest count as zero.
constexpr double kRankTolerance = 1e-9;

constexpr double kStartOffset = 0.3;  // (m) of targets
constexpr Eigen::Index kFewestPoints = 3;

// The rotation that maximises trace(rotation^T matrix).
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& matrix) {
  const Svd svd = ComputeSvd(matrix);
  const Eigen::Matrix3d u = svd.u;
  const Eigen::Matrix3d v = svd.v;
  const double sign = u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0;
  return u * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * v.transpose();
}

bool AllFinite(const Poses& poses) {
  return std::all_of(poses.begin(), poses.end(), [](const auto& pose) {
    return pose.matrix().allFinite();
  });
}

// Whether each index from 0 to count - 1 occurs, and no other.
bool CoversAll(const std::vector<int>& indices, int count) {
  std::vector<bool> occurs(static_cast<std::size_t>(std::max(count, 0)));
  for (const int index : indices) {
    if (index < 0 || index >= count) return false;
    occurs[static_cast<std::size_t>(index)] = true;
  }
  return count > 0 && std::all_of(occurs.begin(), occurs.end(),
                                  [](bool does) { return does; });
}

std::vector<Eigen::Vector3d> StartTargets() {
  std::vector<Eigen::Vector3d> targets = {Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    targets.emplace_back(kStartOffset * Eigen::Vector3d::Unit(axis));
    targets.emplace_back(-targets.back());
  }
  return targets;
}

template <typename Model>
FitRows RowsOf(const Model& model) {
  FitRows rows;
  model.Linearize(&rows);
  return rows;
}

// rows: of the fit; block_size: residuals of an observation; the first
// `num_metres` of them are the residual reported.
StartMisfit Misfit(const FitRows& rows, int block_size, int num_metres) {
  const Eigen::VectorXd all = BlockNorms(rows.residuals, block_size);
  const double cut = kTukeyCut * FitScale(all, rows);
  Eigen::VectorXd norms(all.size());
  StartMisfit misfit;
  for (Eigen::Index i = 0; i < all.size(); ++i) {
    norms[i] = rows.residuals.segment(i * block_size, num_metres).norm();
    if (all[i] >= cut) ++misfit.num_outliers;
  }
  misfit.rms = std::sqrt(norms.squaredNorm() / double(norms.size()));
  double* const middle = norms.data() + norms.size() / 2;
  std::nth_element(norms.data(), middle, norms.data() + norms.size());
  misfit.median = *middle;
  return misfit;
}

template <typename Model>
StartMisfit Misfit(const Model& model) {
  return Misfit(RowsOf(model), Model::kBlockSize,
                std::min(3, Model::kBlockSize));
}

// The base's and the target's rotation that agree best with measured
// orientations M_i = base R_i target: of all pairs of matrices,
// vec(target) ~ sum of (M_i kron R_i)^T vec(base^T).
void StartRotations(const Poses& base_from_last, const Poses& measured,
                    Eigen::Matrix3d* base, Eigen::Matrix3d* target) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(9, 9);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Eigen::Matrix3d last = base_from_last[i].linear();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        sum.block<3, 3>(Eigen::Index{3} * row, Eigen::Index{3} * column) +=
            measured[i].linear()(column, row) * last.transpose();
      }
    }
  }
  const Svd svd = ComputeSvd(sum);
  Eigen::Matrix3d left = svd.u.col(0).reshaped(3, 3);
  Eigen::Matrix3d right = svd.v.col(0).reshaped(3, 3);
  // Singular vectors come with a sign in common.
  if (left.determinant() + right.determinant() < 0.0) {
    left = -left;
    right = -right;
  }
  *base = NearestRotation(right.transpose());
  *target = NearestRotation(left);
}

// The base's rotation for a given rotation of the target.
Eigen::Matrix3d BaseRotation(const Poses& base_from_last, const Poses& measured,
                             const Eigen::Matrix3d& last_from_target) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    sum += measured[i].linear() *
           (base_from_last[i].linear() * last_from_target).transpose();
  }
  return NearestRotation(sum);
}

// The target's rotation for a given rotation of the base.
Eigen::Matrix3d TargetRotation(const Poses& base_from_last,
                               const Poses& measured,
                               const Eigen::Matrix3d& base) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    sum +=
        (base * base_from_last[i].linear()).transpose() * measured[i].linear();
  }
  return NearestRotation(sum);
}

// The place of the base by linear least squares for a target at 0; the first
// Gauss-Newton step solves for both.
Eigen::Vector3d BaseTranslation(const Poses& base_from_last,
                                const Poses& measured,
                                const Eigen::Matrix3d& base) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    sum += measured[i].translation() - base * base_from_last[i].translation();
  }
  return sum / double(measured.size());
}

// Three starts: by the orientations alone, by the positions alone, and with
// the target parallel to the last joint. The first needs turns about two axes,
// the second places that are not on a line.
std::vector<PoseStartModel> PoseStarts(const Poses& base_from_last,
                                       const Poses& measured) {
  const Eigen::Matrix3d parallel = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Matrix3d> bases = {
      BaseRotation(base_from_last, measured, parallel)};
  std::vector<Eigen::Matrix3d> targets = {parallel};
  Eigen::Matrix3Xd measured_positions(3, Eigen::Index(measured.size()));
  for (std::size_t i = 0; i < measured.size(); ++i) {
    measured_positions.col(i) = measured[i].translation();
  }
  const auto by_positions =
      FitRigid(TargetsInBase(base_from_last, Eigen::Vector3d::Zero()),
               measured_positions);
  if (by_positions) {
    bases.emplace_back(by_positions->b_from_a.linear());
    targets.push_back(TargetRotation(base_from_last, measured, bases.back()));
  }
  bases.emplace_back();
  targets.emplace_back();
  StartRotations(base_from_last, measured, &bases.back(), &targets.back());
  std::vector<PoseStartModel> starts;
  for (std::size_t k = 0; k < bases.size(); ++k) {
    PoseStartModel model{&base_from_last, &measured,
                         Eigen::Isometry3d::Identity(),
                         Eigen::Matrix3Xd::Zero(3, 1), targets[k]};
    model.instrument_from_base.linear() = bases[k];
    model.instrument_from_base.translation() =
        BaseTranslation(base_from_last, measured, bases[k]);
    starts.push_back(model);
  }
  return starts;
}

// Anchors from which points x have about the given lengths. With the x
// centred, 2 x.a = |x|^2 - L^2 - mean(|x|^2 - L^2) and
// |a|^2 = mean(L^2 - |x|^2).
std::vector<Eigen::Vector3d> Trilaterate(const Eigen::Matrix3Xd& points,
                                         const Eigen::VectorXd& lengths) {
  const Eigen::Vector3d centre = points.rowwise().mean();
  const Eigen::Matrix3Xd x = points.colwise() - centre;
  const Eigen::VectorXd excess =
      x.colwise().squaredNorm().transpose() - lengths.cwiseAbs2();
  const double distance_squared = -excess.mean();
  const Svd svd = ComputeSvd(x.transpose());
  // u is orthogonal to the mean where its singular value is not zero.
  Eigen::Vector3d in_axes = 0.5 * svd.u.transpose() * excess;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = svd.values[axis];
    const bool has_value = value > kRankTolerance * svd.values[0];
    in_axes[axis] = has_value ? in_axes[axis] / value : 0.0;
  }
  std::vector<Eigen::Vector3d> anchors = {centre + svd.v * in_axes};
  const double height = std::sqrt(
      std::max(0.0, distance_squared - in_axes.head<2>().squaredNorm()));
  for (const double side : {height, -height}) {
    in_axes[2] = side;
    anchors.emplace_back(centre + svd.v * in_axes);
  }
  return anchors;
}

// The rotation by the smallest angle that turns one unit vector into another.
Eigen::Matrix3d ShortestRotation(const Eigen::Vector3d& from,
                                 const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const double sine = across.norm();
  const Eigen::Vector3d axis =
      sine > 0.0 ? Eigen::Vector3d(across / sine) : from.unitOrthogonal();
  return Eigen::AngleAxisd(std::atan2(sine, from.dot(to)), axis)
      .toRotationMatrix();
}

}  // namespace

std::optional<RigidFit> FitRigid(const Eigen::Matrix3Xd& points_in_a,
                                 const Eigen::Matrix3Xd& points_in_b) {
  const Eigen::Index num_points = points_in_a.cols();
  if (num_points < kFewestPoints || points_in_b.cols() != num_points ||
      !points_in_a.allFinite() || !points_in_b.allFinite()) {
    return std::nullopt;
  }
  const Eigen::Vector3d centre_a = points_in_a.rowwise().mean();
  const Eigen::Vector3d centre_b = points_in_b.rowwise().mean();
  const Eigen::Matrix3Xd a = points_in_a.colwise() - centre_a;
  const Eigen::Matrix3Xd b = points_in_b.colwise() - centre_b;
  const Eigen::Matrix3d product = b * a.transpose();
  const Svd svd = ComputeSvd(product);
  RigidFit fit;
  // The product's values go with the squares of the points' distances, and
  // rounding of points far from 0 stays in it.
  const double noise = 1e-15 * (centre_a.norm() + centre_b.norm() + 1e-150) *
                       std::sqrt(a.squaredNorm() + b.squaredNorm());
  const double smallest = std::max(kRankTolerance * svd.values[0], noise);
  fit.is_unique = svd.values[1] > smallest;
  if (fit.is_unique) {
    fit.b_from_a.linear() = NearestRotation(product);
  } else if (svd.values[0] > smallest) {
    fit.b_from_a.linear() = ShortestRotation(svd.v.col(0), svd.u.col(0));
  }
  fit.b_from_a.translation() = centre_b - fit.b_from_a.linear() * centre_a;
  const double aligned = (fit.b_from_a.linear() * a).cwiseProduct(b).sum();
  fit.scale = a.squaredNorm() > 0.0 ? aligned / a.squaredNorm() : 0.0;
  fit.rms = std::sqrt((fit.b_from_a.linear() * a - b).squaredNorm() /
                      double(num_points));
  return fit;
}

std::optional<PositionStart> StartFromPositions(
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const Eigen::Matrix3Xd& measured_positions,
    const std::vector<int>& target_of_observation, int num_targets) {
  const std::size_t num_observations = base_from_last.size();
  if (target_of_observation.size() != num_observations ||
      measured_positions.cols() != Eigen::Index(num_observations) ||
      !CoversAll(target_of_observation, num_targets) ||
      measured_positions.size() < 6 + 3 * num_targets ||
      !AllFinite(base_from_last) || !measured_positions.allFinite()) {
    return std::nullopt;
  }
  std::vector<PositionStartModel> starts;
  for (const Eigen::Vector3d& target : StartTargets()) {
    PositionStartModel model{
        &base_from_last, &measured_positions, &target_of_observation,
        Eigen::Isometry3d::Identity(), target.replicate(1, num_targets)};
    const auto base = FitRigid(model.PointsInBase(), measured_positions);
    if (!base) continue;
    model.instrument_from_base = base->b_from_a;
    starts.push_back(model);
  }
  const auto best = FitFromStarts(starts);
  if (!best) return std::nullopt;
  return PositionStart{best->instrument_from_base, best->targets,
                       Misfit(*best)};
}

std::optional<PoseStart> StartFromPoses(
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const std::vector<Eigen::Isometry3d>& measured_poses) {
  if (measured_poses.size() < kFewestPoints ||
      measured_poses.size() != base_from_last.size() ||
      !AllFinite(base_from_last) || !AllFinite(measured_poses)) {
    return std::nullopt;
  }
  const auto best = FitFromStarts(PoseStarts(base_from_last, measured_poses));
  if (!best) return std::nullopt;
  PoseStart start;
  start.instrument_from_base = best->instrument_from_base;
  start.last_from_target.linear() = best->last_from_target;
  start.last_from_target.translation() = best->targets.col(0);
  start.misfit = Misfit(*best);
  const Eigen::VectorXd residuals = RowsOf(*best).residuals;
  const auto blocks = residuals.reshaped(6, residuals.size() / 6);
  start.rms_rotation = blocks.bottomRows(3).norm() / kMetresPerRadian /
                       std::sqrt(double(blocks.cols()));
  return start;
}

std::optional<FixedPointStart> StartFromFixedPoints(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const std::vector<int>& point_of_observation, int num_points) {
  if (point_of_observation.size() != base_from_last.size() ||
      !CoversAll(point_of_observation, num_points) ||
      Eigen::Index(base_from_last.size()) < 1 + num_points ||
      !AllFinite(base_from_last) || !AllFinite({instrument_from_base})) {
    return std::nullopt;
  }
  const FixedPointStartModel model{&base_from_last, &point_of_observation,
                                   Eigen::Matrix3Xd::Zero(3, 1),
                                   Eigen::Matrix3Xd::Zero(3, num_points)};
  const auto best = FitFromStarts(std::vector<FixedPointStartModel>{model});
  if (!best) return std::nullopt;
  return FixedPointStart{best->targets.col(0),
                         instrument_from_base * best->points, Misfit(*best)};
}

std::optional<DistanceStart> StartFromDistances(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last,
    const Eigen::VectorXd& lengths) {
  if (lengths.size() < 6 ||
      lengths.size() != Eigen::Index(base_from_last.size()) ||
      !lengths.allFinite() || !AllFinite(base_from_last) ||
      !AllFinite({instrument_from_base})) {
    return std::nullopt;
  }
  std::vector<DistanceStartModel> starts;
  for (const Eigen::Vector3d& target : StartTargets()) {
    for (const Eigen::Vector3d& anchor :
         Trilaterate(TargetsInBase(base_from_last, target), lengths)) {
      starts.push_back({&base_from_last, &lengths, target, anchor});
    }
  }
  const auto best = FitFromStarts(starts);
  if (!best) return std::nullopt;
  return DistanceStart{instrument_from_base * best->anchor,
                       best->targets.col(0), Misfit(*best)};
}

std::optional<PlaneStart> StartFromPlane(
    const Eigen::Isometry3d& instrument_from_base,
    const std::vector<Eigen::Isometry3d>& base_from_last) {
  if (base_from_last.size() < 6 || !AllFinite(base_from_last) ||
      !AllFinite({instrument_from_base})) {
    return std::nullopt;
  }
  std::vector<PlaneStartModel> starts;
  for (const Eigen::Vector3d& target : StartTargets()) {
    const Eigen::Matrix3Xd x = TargetsInBase(base_from_last, target);
    const Eigen::Vector3d centre = x.rowwise().mean();
    const Svd svd = ComputeSvd((x.colwise() - centre).transpose());
    for (const int axis : {2, 1, 0}) {
      const Eigen::Vector3d normal = svd.v.col(axis);
      starts.push_back({&base_from_last, target, normal, normal.dot(centre)});
    }
  }
  const auto best = FitFromStarts(starts);
  if (!best) return std::nullopt;
  PlaneStart start;
  start.normal = instrument_from_base.linear() * best->normal;
  start.offset =
      best->offset + start.normal.dot(instrument_from_base.translation());
  start.target = best->targets.col(0);
  start.misfit = Misfit(*best);
  if (start.offset < 0.0) {
    start.normal = -start.normal;
    start.offset = -start.offset;
  }
  return start;
}

}  // namespace alidade::internal
