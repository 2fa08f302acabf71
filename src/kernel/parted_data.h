#ifndef ALIDADE_SRC_KERNEL_PARTED_DATA_H_
#define ALIDADE_SRC_KERNEL_PARTED_DATA_H_

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/common/parallel.h"
#include "src/kernel/aligned.h"
#include "src/kernel/kernel.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/tile_rows.h"
#include "src/kernel/tiles.h"

namespace alidade::internal {

/// What consecutive tiles of a data set add up to.
class Part {
 public:
  explicit Part(int width);

  void Reset();

  /// Adds the cost of a tile. With losses, and `scales_rows`, every row is
  /// multiplied by the root of its observation's weight.
  void AddCost(const std::vector<RobustLoss>& losses, bool scales_rows,
               TileRows* rows);
  /// triangle <- R of [triangle; rows], which are overwritten.
  void AddRows(TileRows* rows);
  /// triangle <- triangle + rows^T rows.
  void AddProducts(TileRows* rows);

  double* triangle() { return triangle_.get(); }
  /// Of all tiles since Reset; lengths in m^2.
  double cost() const { return cost_; }
  double largest_squared_length() const { return largest_; }
  double sum_of_squared_lengths() const { return squares_; }

 private:
  int width_;
  AlignedDoubles triangle_;
  double cost_ = 0.0;
  double largest_ = 0.0;
  double squares_ = 0.0;
};

/// A data set cut into parts, which do not depend on the number of threads, and
/// neither does the order in which they are merged: the parts of each shard,
/// then the shards, those of all ranks that hold some of the data
/// (partition.h), on every rank: what is marked collective is so then.
class PartedData {
 public:
  /// `width` columns of the rows are factored: all derivatives, with or
  /// without the residual.
  PartedData(const MeasurementModel& model, const Dataset& data, int width,
             std::size_t cache_bytes);

  /// Which tiles are looked at: all, or the first of every fourth part.
  enum class Extent { kAll, kSample };

  /// Calls visit(part, rows) for every tile.
  template <typename Visit>
  void ForEachTile(const Eigen::VectorXd& values,
                   const kernel::Columns& columns, const Visit& visit,
                   Extent extent = Extent::kAll) {
    kernel::ComputeConstants(model_.nominal(), model_.references(),
                             model_.layout(), values, &constants_);
    const auto work = [this, &columns, &visit, extent](std::int64_t part,
                                                       std::int64_t /*end*/) {
      Part& mine = parts_[part];
      mine.Reset();
      const BorrowedRows rows(this);
      Range range = ranges_[part];
      if (extent == Extent::kSample) {
        constexpr std::int64_t kStep = 4;
        const std::int64_t tiles = part % kStep == 0 ? 1 : 0;
        range.end = std::min(range.end, range.begin + tiles);
      }
      for (std::int64_t tile = range.begin; tile < range.end; ++tile) {
        rows->Evaluate(constants_, columns, tile);
        visit(&mine, rows.get());
      }
    };
    // By reference, so that std::function need not allocate.
    ParallelFor(model_.num_threads(), static_cast<std::int64_t>(parts_.size()),
                1, std::ref(work));
  }

  /// Each of these is collective, and what the parts held is lost.
  /// R of all parts, width x width.
  void MergeTriangles(Eigen::MatrixXd* factor);
  /// The sum of all parts' triangles; the upper one is filled.
  void SumProducts(Eigen::MatrixXd* sum);
  /// Costs and lengths alone.
  void MergeSums();
  /// As of the last of them.
  const ResidualSummary& summary() const { return summary_; }

  const Tiles& tiles() const { return tiles_; }
  int width() const { return width_; }

 private:
  // Rows that no other thread uses, until the object is gone. As many as
  // threads are enough, and they stay in the threads' caches whatever the
  // number of parts.
  class BorrowedRows {
   public:
    explicit BorrowedRows(PartedData* owner);
    ~BorrowedRows();
    BorrowedRows(const BorrowedRows&) = delete;
    BorrowedRows& operator=(const BorrowedRows&) = delete;
    TileRows* operator->() const { return rows_; }
    TileRows* get() const { return rows_; }

   private:
    PartedData* const owner_;
    TileRows* rows_;
  };

  // Of tiles, and of parts.
  struct Range {
    std::int64_t begin = 0;
    std::int64_t end = 0;
  };
  struct Sums {
    double cost = 0.0;
    double largest = 0.0;  // squared length
    double squares = 0.0;
  };
  enum class Content { kSums, kTriangles, kProducts };

  void AddParts(std::int64_t first_tile, std::int64_t end);
  // triangle <- both.
  void Combine(Content content, const double* other, double* triangle);
  // The shard's first part <- all of its parts.
  Sums MergeShard(Content content, const Range& shard);
  // The first part <- all shards, those of other ranks too.
  void Merge(Content content);
  void MergeRanks(Content content);
  static void Add(const Sums& more, Sums* sums);
  void Summarize(const Sums& sums);

  const MeasurementModel& model_;
  Tiles tiles_;
  const int width_;
  Communicator* const communicator_;
  const Eigen::Index global_observations_;
  std::vector<Range> ranges_;  // tiles of each part
  std::vector<Range> shards_;  // parts of each shard that has some
  std::vector<Part> parts_;
  ResidualSummary summary_;
  std::vector<std::unique_ptr<TileRows>> all_rows_;
  std::mutex free_rows_mutex_;
  std::vector<TileRows*> free_rows_;
  AlignedDoubles work_;
  kernel::Constants constants_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_PARTED_DATA_H_
