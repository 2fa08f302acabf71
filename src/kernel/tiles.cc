#include "src/kernel/tiles.h"

#include <glog/logging.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "alidade/rotation.h"
#include "src/kernel/sine.h"

namespace alidade::internal {
namespace {

// Arrays that hold the measured values of an observation.
std::size_t MeasuredArrays(MeasurementKind kind) {
  return kind == MeasurementKind::kPose ? 12 : RowsOf(kind);
}

// Of a lane in an array of a tile.
std::size_t IndexOf(int array, int lane) {
  return static_cast<std::size_t>(array) * kTile +
         static_cast<std::size_t>(lane);
}

// Pages of 2 MiB instead of 4 KiB where the system has them: a walk through
// gigabytes then hardly ever waits for an address to be translated. A wish, not
// a need.
void AskForLargePages([[maybe_unused]] double* first,
                      [[maybe_unused]] std::size_t size) {
#ifdef __linux__
  constexpr std::size_t kWorthwhile = std::size_t{1} << 23;  // bytes
  constexpr std::uintptr_t kPage = 4096;
  if (size * sizeof(double) < kWorthwhile) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(first);
  const std::size_t skipped = (kPage - begin % kPage) % kPage;
  madvise(reinterpret_cast<char*>(first) + skipped,
          size * sizeof(double) - skipped, MADV_HUGEPAGE);
#endif
}

}  // namespace

Tiles::Tiles(const Arm& arm, const Dataset& data, std::size_t cache_bytes,
             RowScale scale)
    : data_(data), scale_(scale), orders_(data.blocks.size()) {
  for (const Joint& joint : arm.joints) {
    is_revolute_.push_back(joint.type == JointType::kRevolute);
  }
  if (!arm.errors.empty()) flexible_ = arm;
  for (std::size_t shard = 0; shard < data.num_shards(); ++shard) {
    for (std::size_t block = 0; block < data.blocks.size(); ++block) {
      AddGroups(shard, block);
    }
    shard_ends_.push_back(num_tiles_);
  }
  AllocateCache(cache_bytes);
}

// Sines and cosines, and the tilts after them, of one pose after the other.
std::size_t Tiles::JointArrays(MeasurementKind kind) const {
  if (kind == MeasurementKind::kPointDistance) return 0;
  return (kind == MeasurementKind::kDifference ? 2 : 1) *
         (2 * is_revolute_.size() + ErrorArrays());
}

std::size_t Tiles::ErrorArrays() const {
  constexpr std::size_t kMotions = 12;
  if (!flexible_) return 0;
  return 2 * is_revolute_.size() + (HasCovariates() ? kMotions : 0);
}

void Tiles::AppendGroup(const Group& group) {
  groups_.push_back(group);
  groups_.back().first_tile = num_tiles_;
  if (HasOneSigma(group)) ShareSigmas(&groups_.back());
  num_tiles_ += (group.size + kTile - 1) / kTile;
  largest_ = std::max(largest_, SizeOf(groups_.back()));
}

// Whether the sigmas of all observations are the same; of a few, no matter.
bool Tiles::HasOneSigma(const Group& group) const {
  const ObservationBlock& block = data_.blocks[group.block];
  if (scale_ == RowScale::kUnit || group.size < Eigen::Index{2} * kTile ||
      !block.whiteners.empty()) {
    return false;
  }
  const SharedMatrix& sigmas = block.sigmas;
  if (orders_[group.block].empty()) {
    return HaveOneSigma(block, group.first, group.size);
  }
  const Eigen::Index first = InBlock(group, 0);
  for (Eigen::Index i = 1; i < group.size; ++i) {
    if (sigmas.col(InBlock(group, i)) != sigmas.col(first)) return false;
  }
  return true;
}

void Tiles::ShareSigmas(Group* group) {
  const std::size_t size = IndexOf(RowsOf(data_.blocks[group->block].kind), 0);
  shared_sigmas_.push_back(AllocateDoubles(2 * size));
  double* const shared = shared_sigmas_.back().get();
  FillSigmas(*group, 0, kTile, shared);
  const Eigen::Index last = (group->size - 1) / kTile * kTile;
  FillSigmas(*group, last, static_cast<int>(group->size - last), shared + size);
  group->shared_sigmas = shared;
}

void Tiles::AddGroups(std::size_t shard, std::size_t block) {
  const ObservationBlock& observations = data_.blocks[block];
  const MeasurementKind kind = observations.kind;
  const auto key = [&](Eigen::Index i) {
    return std::array<int, 3>{
        observations.target(i),
        HasReference(kind) ? observations.references[i] : -1,
        kind == MeasurementKind::kPointDistance ? observations.seconds[i] : -1};
  };
  const auto [begin, end] = data_.ShardRange(shard, block);
  if (begin == end) return;
  CHECK_LE(end, std::numeric_limits<std::int32_t>::max());
  // Without lists all are alike, and need not be looked at.
  bool uniform = true;
  if (HasReference(kind) || !observations.targets.empty()) {
    for (Eigen::Index i = begin; i < end && uniform; ++i) {
      uniform = key(i) == key(begin);
    }
  }
  std::vector<std::int32_t>& order = orders_[block];
  if (!uniform) {
    if (order.empty()) {
      order.resize(observations.size());
      std::iota(order.begin(), order.end(), 0);
    }
    std::stable_sort(
        order.begin() + begin, order.begin() + end,
        [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  }
  const auto at = [&](Eigen::Index i) { return order.empty() ? i : order[i]; };
  for (Eigen::Index first = begin; first < end;) {
    Eigen::Index last = uniform ? end : first + 1;
    while (last < end && key(at(last)) == key(at(first))) ++last;
    const auto [target, reference, second] = key(at(first));
    AppendGroup({static_cast<int>(block), target, reference, second, first,
                 last - first});
    first = last;
  }
}

const Tiles::Group& Tiles::GroupOf(std::int64_t tile) const {
  const auto after = std::upper_bound(
      groups_.begin(), groups_.end(), tile,
      [](std::int64_t t, const Group& group) { return t < group.first_tile; });
  return *(after - 1);
}

std::size_t Tiles::SizeOf(const Group& group) const {
  const MeasurementKind kind = data_.blocks[group.block].kind;
  std::size_t arrays = JointArrays(kind) + MeasuredArrays(kind);
  if (group.shared_sigmas == nullptr) arrays += RowsOf(kind);
  return arrays * kTile;
}

Eigen::Index Tiles::InBlock(const Group& group, Eigen::Index i) const {
  const std::vector<std::int32_t>& order = orders_[group.block];
  return order.empty() ? group.first + i : order[group.first + i];
}

Eigen::Index Tiles::Observation(std::int64_t tile, int lane) const {
  const Group& group = GroupOf(tile);
  return InBlock(group, (tile - group.first_tile) * kTile + lane);
}

void Tiles::AllocateCache(std::size_t cache_bytes) {
  std::size_t size = 0;
  for (const Group& group : groups_) {
    offsets_.push_back(size);
    const std::size_t each = SizeOf(group);
    const std::size_t left = cache_bytes / sizeof(double) - size;
    const std::int64_t wanted = (group.size + kTile - 1) / kTile;
    const std::int64_t taken =
        std::min<std::int64_t>(wanted, static_cast<std::int64_t>(left / each));
    size += each * static_cast<std::size_t>(taken);
    num_cached_ += taken;
    if (taken < wanted) break;
  }
  if (num_cached_ == 0) return;
  cache_ = AllocateDoubles(size);
  AskForLargePages(cache_.get(), size);
  is_filled_.assign(static_cast<std::size_t>(num_cached_), 0);
}

Tile Tiles::Get(std::int64_t tile, double* scratch) {
  if (tile >= num_cached_) return Fill(tile, scratch);
  double* const arrays = Cached(tile);
  char& is_filled = is_filled_[static_cast<std::size_t>(tile)];
  Tile cached = is_filled != 0 ? Layout(tile, arrays) : Fill(tile, arrays);
  is_filled = 1;
  if (tile + 1 < num_cached_) {
    cached.next = Cached(tile + 1);
    cached.next_arrays = static_cast<int>(SizeOf(GroupOf(tile + 1)) / kTile);
  }
  return cached;
}

double* Tiles::Cached(std::int64_t tile) const {
  const Group& group = GroupOf(tile);
  return cache_.get() + offsets_[&group - groups_.data()] +
         SizeOf(group) * static_cast<std::size_t>(tile - group.first_tile);
}

Tile Tiles::Layout(std::int64_t tile, const double* arrays) const {
  const Group& group = GroupOf(tile);
  const MeasurementKind kind = data_.blocks[group.block].kind;
  const std::size_t joint_arrays = JointArrays(kind);
  Tile result;
  result.kind = kind;
  result.block = group.block;
  result.target = group.target;
  result.reference = group.reference;
  result.second = group.second;
  result.count = static_cast<int>(std::min<Eigen::Index>(
      kTile, group.size - (tile - group.first_tile) * kTile));
  result.joints = arrays;
  result.second_joints = arrays + joint_arrays / 2 * kTile;
  if (flexible_ && joint_arrays > 0) {
    const std::size_t turns = 2 * is_revolute_.size() * kTile;
    result.tilts = result.joints + turns;
    result.second_tilts = result.second_joints + turns;
    if (HasCovariates()) {
      result.motions = result.tilts + turns;
      result.second_motions = result.second_tilts + turns;
    }
  }
  result.measured = arrays + joint_arrays * kTile;
  if (group.shared_sigmas == nullptr) {
    result.inverse_sigmas = result.measured + MeasuredArrays(kind) * kTile;
  } else {
    const bool is_last = (tile - group.first_tile + 1) * kTile >= group.size;
    result.inverse_sigmas =
        group.shared_sigmas + (is_last ? RowsOf(kind) * kTile : 0);
  }
  return result;
}

Tile Tiles::Fill(std::int64_t tile, double* arrays) const {
  const Group& group = GroupOf(tile);
  const MeasurementKind kind = data_.blocks[group.block].kind;
  const Tile result = Layout(tile, arrays);
  const Eigen::Index first = (tile - group.first_tile) * kTile;
  const std::size_t joint_arrays = JointArrays(kind);
  if (joint_arrays > 0) {
    FillJoints(group, first, result.count, false, arrays);
  }
  if (kind == MeasurementKind::kDifference) {
    FillJoints(group, first, result.count, true,
               arrays + joint_arrays / 2 * kTile);
  }
  double* const measured = arrays + joint_arrays * kTile;
  FillMeasured(group, first, result.count, measured);
  if (group.shared_sigmas == nullptr) {
    FillSigmas(group, first, result.count,
               measured + MeasuredArrays(kind) * kTile);
  }
  return result;
}

void Tiles::FillJoints(const Group& group, Eigen::Index first, int count,
                       bool second, double* arrays) const {
  const ObservationBlock& block = data_.blocks[group.block];
  std::array<Eigen::Index, kTile> poses{};
  for (int lane = 0; lane < count; ++lane) {
    const Eigen::Index i = InBlock(group, first + lane);
    poses[lane] = second ? block.seconds[i] : block.pose(i);
  }
  for (std::size_t j = 0; j < is_revolute_.size(); ++j) {
    double* const sines = arrays + 2 * j * kTile;
    double* const cosines = sines + kTile;
    std::fill(sines, cosines + kTile, 0.0);
    const auto row = static_cast<Eigen::Index>(j);
    for (int lane = 0; lane < count; ++lane) {
      sines[lane] = data_.joint_values(row, poses[lane]);
    }
    if (!flexible_ && is_revolute_[j]) kernel::SineAndCosine(sines, cosines);
  }
  if (flexible_) AddErrors(poses, count, arrays);
}

// From the joint values, where their sines are to be.
void Tiles::AddErrors(const std::array<Eigen::Index, kTile>& poses, int count,
                      double* arrays) const {
  const std::size_t n = is_revolute_.size();
  double* const tilts = arrays + 2 * n * kTile;
  double* const motions = tilts + 2 * n * kTile;
  std::fill(tilts, tilts + ErrorArrays() * kTile, 0.0);
  Eigen::VectorXd q(static_cast<Eigen::Index>(n));
  for (int lane = 0; lane < count; ++lane) {
    for (std::size_t j = 0; j < n; ++j) {
      q[static_cast<Eigen::Index>(j)] = arrays[2 * j * kTile + lane];
    }
    const PoseErrors errors = ErrorsAt(
        *flexible_, q.data(),
        CovariatesAt(data_, *flexible_, static_cast<int>(poses[lane])).data());
    for (int k = 0; HasCovariates() && k < 6; ++k) {
      motions[IndexOf(k, lane)] = errors.base[k];
      motions[IndexOf(k + 6, lane)] = errors.target[k];
    }
    for (std::size_t j = 0; j < n; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      arrays[2 * j * kTile + lane] += errors.shifts[column];
      tilts[2 * j * kTile + lane] = errors.tilts(0, column);
      tilts[(2 * j + 1) * kTile + lane] = errors.tilts(1, column);
    }
  }
  for (std::size_t j = 0; j < n; ++j) {
    double* const sines = arrays + 2 * j * kTile;
    if (is_revolute_[j]) kernel::SineAndCosine(sines, sines + kTile);
  }
}

void Tiles::FillSigmas(const Group& group, Eigen::Index first, int count,
                       double* inverse_sigmas) const {
  const ObservationBlock& block = data_.blocks[group.block];
  const int rows = block.rows_each();
  std::fill(inverse_sigmas, inverse_sigmas + IndexOf(rows, 0), 0.0);
  for (int lane = 0; lane < count; ++lane) {
    const Eigen::Index i = InBlock(group, first + lane);
    const bool is_scaled_later =
        scale_ == RowScale::kUnit ||
        (!block.whiteners.empty() && block.whiteners[i].size() > 0);
    for (int row = 0; row < rows; ++row) {
      const double sigma = block.sigmas(row, i);
      inverse_sigmas[IndexOf(row, lane)] =
          is_scaled_later ? (std::isinf(sigma) ? 0.0 : 1.0) : 1.0 / sigma;
    }
  }
}

void Tiles::FillMeasured(const Group& group, Eigen::Index first, int count,
                         double* measured) const {
  const ObservationBlock& block = data_.blocks[group.block];
  const int rows = std::min(3, block.rows_each());
  std::fill(measured, measured + MeasuredArrays(block.kind) * kTile, 0.0);
  for (int lane = 0; lane < count; ++lane) {
    const Eigen::Index i = InBlock(group, first + lane);
    for (int row = 0; row < rows; ++row) {
      // What was not measured may be anything in the data, NaN too.
      if (!std::isinf(block.sigmas(row, i))) {
        measured[IndexOf(row, lane)] = block.measured(row, i);
      }
    }
    if (block.kind != MeasurementKind::kPose) continue;
    // An orientation is one thing: any of its rows needs it as a whole.
    Eigen::Vector3d vector = Eigen::Vector3d::Zero();
    if (block.sigmas.col(i).tail<3>().array().isFinite().any()) {
      vector = block.measured.col(i).tail<3>();
    }
    const Eigen::Matrix3d rotation = RotationFromVector<double>(vector);
    for (int k = 0; k < 9; ++k) {
      measured[IndexOf(3 + k, lane)] = rotation(k / 3, k % 3);
    }
  }
}

}  // namespace alidade::internal
