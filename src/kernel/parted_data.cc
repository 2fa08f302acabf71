#include "src/kernel/parted_data.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/common/bytes.h"
#include "src/kernel/lane_factor.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// A data set is cut into so many parts at most, of so many tiles at least:
// enough for the threads to share, few enough for their merging not to show.
constexpr std::int64_t kMostParts = 64;
constexpr std::int64_t kFewestTiles = 16;

int VectorsOf(const TileRows& rows) {
  return rows.height() * kTile / static_cast<int>(kernel::Lanes());
}

// Rows of an observation that were measured.
int MeasuredRows(const TileRows& rows, int lane) {
  int dimension = 0;
  for (int row = 0; row < rows.height(); ++row) {
    const double inverse = rows.tile().inverse_sigmas[row * kTile + lane];
    dimension += inverse > 0.0 ? 1 : 0;
  }
  return dimension;
}

}  // namespace

Part::Part(int width)
    : width_(width), triangle_(AllocateDoubles(kernel::TriangleSize(width))) {
  Reset();
}

void Part::Reset() {
  std::fill_n(triangle_.get(), kernel::TriangleSize(width_), 0.0);
  cost_ = 0.0;
  largest_ = 0.0;
  squares_ = 0.0;
}

void Part::AddCost(const std::vector<RobustLoss>& losses, bool scales_rows,
                   TileRows* rows) {
  alignas(64) std::array<double, kTile> norms;
  const kernel::TileSums sums = kernel::SumTile(
      rows->height(), rows->residual(), rows->lengths(), norms.data());
  // NaN may be lost here; the cost is then NaN, and nobody asks for more.
  largest_ = std::max(largest_, sums.largest_length);
  squares_ += sums.squared_lengths;
  if (losses.empty()) {
    cost_ += sums.chi_square;
    return;
  }
  std::array<double, kTile> weights{};
  for (int t = 0; t < rows->tile().count; ++t) {
    const int dimension = MeasuredRows(*rows, t);
    if (dimension == 0) continue;
    std::array<double, 3> rho{};
    losses[dimension - 1].Evaluate(norms[t], rho.data());
    cost_ += rho[0];
    weights[t] = std::sqrt(rho[1]);
  }
  if (!scales_rows) return;
  const int arrays = (rows->num_derivatives() + 1) * rows->height();
  for (int k = 0; k < arrays; ++k) {
    double* const array = rows->rows() + static_cast<std::ptrdiff_t>(k) * kTile;
    for (int t = 0; t < kTile; ++t) array[t] *= weights[t];
  }
}

void Part::AddRows(TileRows* rows) {
  kernel::AddRows(width_, VectorsOf(*rows), rows->stride(), rows->rows(),
                  triangle_.get());
}

void Part::AddProducts(TileRows* rows) {
  kernel::AddProducts(width_, VectorsOf(*rows), rows->stride(), rows->rows(),
                      triangle_.get());
}

PartedData::PartedData(const MeasurementModel& model, const Dataset& data,
                       int width, std::size_t cache_bytes)
    : model_(model),
      tiles_(model.nominal(), data, cache_bytes),
      width_(width),
      communicator_(HoldersOf(model.communicator(), data)),
      global_observations_(data.global_observations()),
      work_(AllocateDoubles(kernel::MergeSize(width))) {
  std::int64_t first_tile = 0;
  for (const std::int64_t end : tiles_.shard_ends()) {
    AddParts(first_tile, end);
    first_tile = end;
  }
  // Somewhere the sum of nothing must be.
  if (ranges_.empty()) ranges_.emplace_back();
  const auto count = static_cast<std::int64_t>(ranges_.size());
  parts_.reserve(count);
  for (std::int64_t k = 0; k < count; ++k) parts_.emplace_back(width);
  const std::int64_t users =
      std::min<std::int64_t>(count, std::max(1, model.num_threads()));
  for (std::int64_t k = 0; k < users; ++k) {
    all_rows_.push_back(std::make_unique<TileRows>(
        &tiles_, model.layout().num_joints(), width));
    free_rows_.push_back(all_rows_.back().get());
  }
}

void PartedData::AddParts(std::int64_t first_tile, std::int64_t end) {
  const std::int64_t tiles = end - first_tile;
  if (tiles == 0) return;
  const std::int64_t wanted =
      std::clamp<std::int64_t>(tiles / kFewestTiles, 1, kMostParts);
  const std::int64_t size = (tiles + wanted - 1) / wanted;
  Range parts;
  parts.begin = static_cast<std::int64_t>(ranges_.size());
  for (std::int64_t tile = first_tile; tile < end; tile += size) {
    ranges_.push_back({tile, std::min(end, tile + size)});
  }
  parts.end = static_cast<std::int64_t>(ranges_.size());
  shards_.push_back(parts);
}

PartedData::BorrowedRows::BorrowedRows(PartedData* owner) : owner_(owner) {
  const std::lock_guard<std::mutex> lock(owner_->free_rows_mutex_);
  rows_ = owner_->free_rows_.back();
  owner_->free_rows_.pop_back();
}

PartedData::BorrowedRows::~BorrowedRows() {
  const std::lock_guard<std::mutex> lock(owner_->free_rows_mutex_);
  owner_->free_rows_.push_back(rows_);
}

void PartedData::Combine(Content content, const double* other,
                         double* triangle) {
  if (content == Content::kTriangles) {
    kernel::MergeTriangles(width_, other, work_.get(), triangle);
  } else if (content == Content::kProducts) {
    for (std::size_t i = 0; i < kernel::TriangleSize(width_); ++i) {
      triangle[i] += other[i];
    }
  }
}

void PartedData::Add(const Sums& more, Sums* sums) {
  sums->cost += more.cost;
  sums->squares += more.squares;
  sums->largest = std::max(sums->largest, more.largest);
}

void PartedData::Merge(Content content) {
  if (communicator_->size() > 1) {
    MergeRanks(content);
    return;
  }
  Sums all;
  for (const Range& shard : shards_) {
    Add(MergeShard(content, shard), &all);
    if (shard.begin == 0) continue;
    Combine(content, parts_[shard.begin].triangle(), parts_[0].triangle());
  }
  Summarize(all);
}

PartedData::Sums PartedData::MergeShard(Content content, const Range& shard) {
  Sums sums;
  for (std::int64_t k = shard.begin; k < shard.end; ++k) {
    Add({parts_[k].cost(), parts_[k].largest_squared_length(),
         parts_[k].sum_of_squared_lengths()},
        &sums);
    if (k == shard.begin) continue;
    Combine(content, parts_[k].triangle(), parts_[shard.begin].triangle());
  }
  return sums;
}

// Every shard is one message, so that they are merged in the global order,
// whoever has them.
void PartedData::MergeRanks(Content content) {
  const std::size_t size =
      content == Content::kSums ? 0 : kernel::TriangleSize(width_);
  ByteWriter writer;
  for (const Range& shard : shards_) {
    writer.Put(MergeShard(content, shard));
    writer.PutArray(parts_[shard.begin].triangle(), size);
  }
  const std::vector<std::string> ranks = communicator_->Gather(writer.Take());
  const AlignedDoubles triangle = AllocateDoubles(size);
  Sums all;
  bool is_first = true;
  for (const std::string& bytes : ranks) {
    ByteReader reader(bytes);
    while (!reader.is_at_end()) {
      Add(reader.Get<Sums>(), &all);
      double* const to = is_first ? parts_[0].triangle() : triangle.get();
      reader.GetArray(size, to);
      if (!is_first) Combine(content, to, parts_[0].triangle());
      is_first = false;
    }
  }
  Summarize(all);
}

void PartedData::MergeTriangles(Eigen::MatrixXd* factor) {
  Merge(Content::kTriangles);
  kernel::MergeLanes(width_, parts_[0].triangle(), work_.get(), factor);
}

void PartedData::SumProducts(Eigen::MatrixXd* sum) {
  Merge(Content::kProducts);
  kernel::SumLanes(width_, parts_[0].triangle(), sum);
}

void PartedData::MergeSums() { Merge(Content::kSums); }

void PartedData::Summarize(const Sums& sums) {
  const auto count = static_cast<double>(global_observations_);
  summary_.cost = sums.cost;
  summary_.max_error = std::sqrt(sums.largest);
  summary_.rms_error = std::sqrt(sums.squares / std::max(1.0, count));
}

}  // namespace alidade::internal
