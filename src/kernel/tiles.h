#ifndef ALIDADE_SRC_KERNEL_TILES_H_
#define ALIDADE_SRC_KERNEL_TILES_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "src/kernel/aligned.h"

namespace alidade::internal {

/// Observations of one kind, one target and one pair of references, as a
/// structure of arrays of kTile numbers each. What lies after `count` is
/// padding: finite, with inverse sigmas of zero.
struct Tile {
  MeasurementKind kind = MeasurementKind::kPosition;
  int block = 0;  ///< of the data set
  int target = 0;
  int reference = -1;  ///< -1: the kind has none
  int second = -1;     ///< second reference point of kPointDistance
  int count = 0;
  /// For each joint kTile sines, then kTile cosines; of a prismatic joint its
  /// values, then zeros.
  const double* joints = nullptr;
  const double* second_joints = nullptr;  ///< of kDifference
  /// For each joint kTile tilts about x, then about y, as error_terms.h has
  /// them; null for a rigid arm.
  const double* tilts = nullptr;
  const double* second_tilts = nullptr;
  /// Six arrays that covariates move the base by, then six of the targets; null
  /// where there are none.
  const double* motions = nullptr;
  const double* second_motions = nullptr;
  /// An array for each row (m); of kPose three of the position (m) and nine of
  /// the measured rotation matrix, row by row.
  const double* measured = nullptr;
  /// An array for each row: 1 / sigma, 0 where the row was not measured; 1
  /// instead of 1 / sigma for observations with a whitener.
  const double* inverse_sigmas = nullptr;
  /// All arrays of the tile after it, where they are cached: the kernel asks
  /// the memory for them while it works on this one.
  const double* next = nullptr;
  int next_arrays = 0;
};

/// What the kernel's rows are multiplied by.
enum class RowScale {
  kWhitened,  ///< 1 / sigma, or what a covariance makes of them
  kUnit,      ///< 1 where a row was measured: errors in m and rad
};

/// A data set cut into tiles. Sines and cosines are taken once, when a tile is
/// first asked for, and kept for as many tiles as the cache may hold; of later
/// tiles they are taken anew at every call of Get. Holds references: arm's
/// joint types and data must not change.
class Tiles {
 public:
  /// `cache_bytes`: what all cached tiles may take together.
  Tiles(const Arm& arm, const Dataset& data, std::size_t cache_bytes,
        RowScale scale = RowScale::kWhitened);

  const Dataset& data() const { return data_; }
  RowScale scale() const { return scale_; }
  std::int64_t size() const { return num_tiles_; }
  /// Where the tiles of each shard end; those of the first begin at 0. A tile
  /// is of one shard.
  const std::vector<std::int64_t>& shard_ends() const { return shard_ends_; }
  /// Doubles that Get needs where it cannot take them from the cache.
  std::size_t scratch_size() const { return largest_; }

  /// Not for the same tile from two threads at once.
  /// @pre scratch: scratch_size() doubles, aligned to 64 bytes.
  Tile Get(std::int64_t tile, double* scratch);

  /// The observation of the tile's block in lane `lane` of the tile.
  Eigen::Index Observation(std::int64_t tile, int lane) const;

 private:
  // Observations of a block with the same target and references.
  struct Group {
    int block = 0;
    int target = 0;
    int reference = -1;
    int second = -1;
    Eigen::Index first = 0;  // in the order of the block
    Eigen::Index size = 0;
    std::int64_t first_tile = 0;
    // Inverse sigmas of a full tile, then of the last one, where those of all
    // observations are the same: no tile has its own. Null: each has.
    const double* shared_sigmas = nullptr;
  };

  void AddGroups(std::size_t shard, std::size_t block);
  void AppendGroup(const Group& group);
  bool HasOneSigma(const Group& group) const;
  void ShareSigmas(Group* group);
  const Group& GroupOf(std::int64_t tile) const;
  std::size_t SizeOf(const Group& group) const;
  // Where a tile is in the cache.
  double* Cached(std::int64_t tile) const;
  Eigen::Index InBlock(const Group& group, Eigen::Index i) const;
  void AllocateCache(std::size_t cache_bytes);
  // Writes the arrays of a tile and returns where they are.
  Tile Fill(std::int64_t tile, double* arrays) const;
  void FillJoints(const Group& group, Eigen::Index first, int count,
                  bool second, double* arrays) const;
  void AddErrors(const std::array<Eigen::Index, kTile>& poses, int count,
                 double* arrays) const;
  bool HasCovariates() const {
    return flexible_ && !flexible_->errors.covariates.empty();
  }
  /// Arrays of tilts and base of one pose.
  std::size_t ErrorArrays() const;
  void FillMeasured(const Group& group, Eigen::Index first, int count,
                    double* measured) const;
  void FillSigmas(const Group& group, Eigen::Index first, int count,
                  double* inverse_sigmas) const;
  Tile Layout(std::int64_t tile, const double* arrays) const;

  // Arrays of the joints of an observation's poses.
  std::size_t JointArrays(MeasurementKind kind) const;

  const Dataset& data_;
  const RowScale scale_;
  std::vector<bool> is_revolute_;
  std::optional<Arm> flexible_;  // where it has error terms
  std::vector<Group> groups_;
  std::vector<AlignedDoubles> shared_sigmas_;
  // For each block its observations, sorted by group; empty: as they are.
  std::vector<std::vector<std::int32_t>> orders_;
  std::int64_t num_tiles_ = 0;
  std::vector<std::int64_t> shard_ends_;
  std::size_t largest_ = 0;

  AlignedDoubles cache_;
  // Where the tiles of each group begin in the cache.
  std::vector<std::size_t> offsets_;
  std::int64_t num_cached_ = 0;
  std::vector<char> is_filled_;  // of each tile that has room in the cache
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_TILES_H_
