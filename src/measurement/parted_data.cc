#include "parted_data.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lane_factor.h"

namespace alidade {
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
      tiles_(model.nominal(), data, cache_bytes, model.num_threads()),
      width_(width),
      work_(AllocateDoubles(kernel::MergeSize(width))) {
  const std::int64_t tiles = tiles_.size();
  const std::int64_t wanted =
      std::clamp<std::int64_t>(tiles / kFewestTiles, 1, kMostParts);
  part_size_ = std::max<std::int64_t>(1, (tiles + wanted - 1) / wanted);
  const std::int64_t count =
      std::max<std::int64_t>(1, (tiles + part_size_ - 1) / part_size_);
  parts_.reserve(count);
  for (std::int64_t k = 0; k < count; ++k) parts_.emplace_back(width);
  const std::int64_t users =
      std::min<std::int64_t>(count, std::max(1, model.num_threads()));
  for (std::int64_t k = 0; k < users; ++k) {
    all_rows_.push_back(
        std::make_unique<TileRows>(tiles_, model.layout().num_joints(), width));
    free_rows_.push_back(all_rows_.back().get());
  }
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

void PartedData::MergeTriangles(Eigen::MatrixXd* factor) {
  double* const all = parts_.front().triangle();
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    kernel::MergeTriangles(width_, parts_[k].triangle(), work_.get(), all);
  }
  kernel::MergeLanes(width_, all, work_.get(), factor);
}

void PartedData::SumProducts(Eigen::MatrixXd* sum) {
  double* const all = parts_.front().triangle();
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    const double* const triangle = parts_[k].triangle();
    for (std::size_t i = 0; i < kernel::TriangleSize(width_); ++i) {
      all[i] += triangle[i];
    }
  }
  kernel::SumLanes(width_, all, sum);
}

ResidualSummary PartedData::Summary() const {
  ResidualSummary summary;
  double squares = 0.0;
  for (const Part& part : parts_) {
    summary.cost += part.cost();
    squares += part.sum_of_squared_lengths();
    summary.max_error =
        std::max(summary.max_error, part.largest_squared_length());
  }
  const auto count = static_cast<double>(tiles_.data().num_observations());
  summary.max_error = std::sqrt(summary.max_error);
  summary.rms_error = std::sqrt(squares / std::max(1.0, count));
  return summary;
}

}  // namespace alidade
