#ifndef ALIDADE_DATASET_H_
#define ALIDADE_DATASET_H_

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/shared_matrix.h"

namespace alidade {

/// Where a pose was read: for messages.
struct PoseSource {
  int file = 0;  ///< index in Dataset::files
  int line = 0;  ///< from 1
};

/// Where each of many poses was read, in the order of poses. Poses of
/// consecutive lines take no memory of their own.
class PoseSources {
 public:
  /// Poses of consecutive lines.
  struct Run {
    std::size_t first_pose = 0;
    PoseSource source = {};  ///< of that pose
  };

  void push_back(const PoseSource& source);
  /// `count` poses, of `first` and the lines after it.
  void Append(const PoseSource& first, std::size_t count);
  /// All of others, whose files are numbered from `first_file` on here.
  void Append(const PoseSources& others, int first_file);
  /// Adds to every line.
  void MoveLines(int difference);

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  /// O(log runs). @pre pose < size().
  PoseSource operator[](std::size_t pose) const;

  const std::vector<Run>& runs() const { return runs_; }

 private:
  std::vector<Run> runs_;
  std::size_t size_ = 0;
};

/// What is measured. With p the position of the target at the observation's
/// pose, R its orientation, both in the instrument's frame, and "m" what was
/// measured, the residual (predicted minus measured) is
///
///   kPosition       p - p_m                                   3 rows (m)
///   kPose           p - p_m;  Log(R R_m^T)                    3 (m), 3 (rad)
///   kDistance       |p - c| - L_m, c a reference point        1 row (m)
///   kFixedPoint     p - c: a ball in a socket                 3 rows (m)
///   kPlane          n . p - offset: contact with a plane      1 row (m)
///   kDifference     p - p' - d_m, p' at a second pose         3 rows (m)
///   kPointDistance  |c - c'| - L_m of two reference points    1 row (m)
enum class MeasurementKind {
  kPosition,
  kPose,
  kDistance,
  kFixedPoint,
  kPlane,
  kDifference,
  kPointDistance,
};

/// "position", "pose", "distance", "fixed point", "plane", "difference", "point
/// distance".
const char* NameOf(MeasurementKind kind);

/// Whether the position of the target itself is measured: kPosition, kPose.
bool HoldsPosition(MeasurementKind kind);

/// Whether an observation names a reference point or plane.
bool HasReference(MeasurementKind kind);

/// Whether an observation names a second pose or point.
bool HasSecond(MeasurementKind kind);

/// Rows of one observation: 3, 6 or 1.
int RowsOf(MeasurementKind kind);

/// Observations of one kind, as a structure of arrays: column i of each matrix
/// and entry i of each list belong to observation i.
struct ObservationBlock {
  MeasurementKind kind = MeasurementKind::kPosition;
  /// Column of the pose in Dataset::joint_values; empty: observation i is of
  /// pose i. (Of kPointDistance: not used.)
  std::vector<int> poses = {};
  /// Number of the target; empty: the first.
  std::vector<int> targets = {};
  /// Number of the reference point (kDistance, kFixedPoint, kPointDistance) or
  /// plane (kPlane).
  std::vector<int> references = {};
  /// The second pose (kDifference) or the second point (kPointDistance).
  std::vector<int> seconds = {};
  /// RowsOf(kind) x M (m, rad); orientations as rotation vectors; zero for
  /// kFixedPoint and kPlane.
  SharedMatrix measured = {};
  /// Standard deviation of each row of the residual, RowsOf(kind) x M (m, rad),
  /// positive; infinite where that row was not measured.
  SharedMatrix sigmas = {};
  /// Where an observation's rows are correlated: W with W^T W the inverse of
  /// their covariance; the whitened residual is W e instead of e / sigma. One
  /// entry per observation or none at all; an empty matrix leaves the sigmas.
  std::vector<Eigen::MatrixXd> whiteners = {};

  Eigen::Index size() const { return measured.cols(); }
  int rows_each() const { return RowsOf(kind); }
  int pose(Eigen::Index i) const {
    return poses.empty() ? static_cast<int>(i) : poses[i];
  }
  int target(Eigen::Index i) const { return targets.empty() ? 0 : targets[i]; }
  /// Rows of observation i that were measured.
  int Dimension(Eigen::Index i) const;
};

/// Where what came from one file begins.
struct Shard {
  Eigen::Index first_pose = 0;
  std::vector<Eigen::Index> first_observations = {};  ///< of each block
};

/// Where the poses and observations of a data set stand in a global one, of
/// which each rank of a communicator holds a part (docs/cluster.md). The global
/// one is never in one place; its poses, and the observations of each of its
/// blocks, are those of rank 0, then those of rank 1 and so on.
struct Partition {
  Eigen::Index first_pose = 0;
  Eigen::Index global_poses = 0;
  /// The same for the observations of each block.
  std::vector<Eigen::Index> first_observations = {};
  std::vector<Eigen::Index> global_observations = {};
};

/// Measurements of an arm at known joint values. Observations are counted, and
/// their residual rows stacked, block after block. Numbers of poses and
/// observations may be those of a mapped file (shared_matrix.h).
struct Dataset {
  std::string name;  ///< file it came from, for messages
  /// Joint values, num_joints x poses (rad for revolute, m for prismatic).
  SharedMatrix joint_values;
  /// What else was recorded of each pose (temperature, tilt, station), names x
  /// poses, in the units of its column; or empty.
  std::vector<std::string> covariate_names = {};
  SharedMatrix covariates = {};
  std::vector<ObservationBlock> blocks;
  /// One entry per pose, or none where the data come from no file.
  PoseSources sources = {};
  std::vector<std::string> files = {};
  /// One entry per file, in ascending order; empty: all is one. What is summed
  /// or factored over all poses is so for each shard first, then over shards,
  /// so that bits do not depend on who has which of them.
  std::vector<Shard> shards = {};
  /// Nothing: the data set is a global one. Of a part, blocks are the same on
  /// every rank, if empty on some.
  std::optional<Partition> partition = {};

  int num_joints() const { return static_cast<int>(joint_values.rows()); }
  Eigen::Index num_poses() const { return joint_values.cols(); }
  Eigen::Index num_observations() const;
  /// Rows of the stacked residual, those not measured (always zero) included.
  Eigen::Index num_rows() const;
  /// Number of scalar measurements here.
  Eigen::Index num_equations() const;
  /// Whether the global data set has any.
  bool Has(MeasurementKind kind) const;

  /// Of the global data set.
  Eigen::Index global_poses() const;
  Eigen::Index global_observations() const;
  Eigen::Index global_observations(std::size_t block) const;
  std::size_t num_shards() const {
    return std::max<std::size_t>(1, shards.size());
  }
  /// The observations [first, second) of a block that belong to a shard.
  std::pair<Eigen::Index, Eigen::Index> ShardRange(std::size_t shard,
                                                   std::size_t block) const;

  /// The measured points and their sigmas (3 x poses, m) of a data set of one
  /// block of positions, as MakePositions returns it; an empty data set becomes
  /// one. @pre there is no other block.
  SharedMatrix& positions() { return PositionBlock().measured; }
  SharedMatrix& sigmas() { return PositionBlock().sigmas; }
  const SharedMatrix& positions() const { return blocks.front().measured; }
  const SharedMatrix& sigmas() const { return blocks.front().sigmas; }

 private:
  ObservationBlock& PositionBlock();
};

/// The covariates that an arm's error terms ask for at a pose (error_terms.h);
/// of what the data do not have the reference.
Eigen::VectorXd CovariatesAt(const Dataset& data, const Arm& arm, int pose);

/// A row of a data file that holds no measurement.
struct RejectedRow {
  std::string file;
  int line = 0;
  std::string reason;
};

/// "file:line" of a pose; empty where it comes from no file.
std::string SourceOf(const Dataset& data, int pose);

/// Whether the sigmas of observations [first, first + count) of a block are the
/// same. O(count), at the speed of memory.
bool HaveOneSigma(const ObservationBlock& block, Eigen::Index first,
                  Eigen::Index count);

/// One measured position per pose: joint values n x N, points 3 x N (m), sigmas
/// 3 x N (m).
Dataset MakePositions(SharedMatrix joint_values, SharedMatrix points,
                      SharedMatrix sigmas);
/// The same with one standard deviation of every coordinate (m).
Dataset MakePositions(SharedMatrix joint_values, SharedMatrix points,
                      double sigma);

/// Clears the block's list of poses where it says nothing: 0, 1, ... of a data
/// set with as many poses, or observations that belong to none.
void DropTrivialPoses(Eigen::Index num_poses, ObservationBlock* block);

/// Whitens stacked rows (residuals or a Jacobian) of `count` observations of a
/// block from `first` on, in place. Rows that were not measured become zero.
void Whiten(const ObservationBlock& block, Eigen::Index first,
            Eigen::Index count, Eigen::Ref<Eigen::MatrixXd> rows);

}  // namespace alidade

#endif  // ALIDADE_DATASET_H_
