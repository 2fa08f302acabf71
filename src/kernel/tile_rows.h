#ifndef ALIDADE_SRC_KERNEL_TILE_ROWS_H_
#define ALIDADE_SRC_KERNEL_TILE_ROWS_H_

#include <cstddef>
#include <cstdint>

#include "src/kernel/aligned.h"
#include "src/kernel/kernel.h"
#include "src/kernel/tiles.h"

namespace alidade::internal {

/// The whitened rows of one tile after the other: memory for the kernel, and
/// the whitening by full covariances, which the kernel leaves out. One object
/// per thread.
class TileRows {
 public:
  /// For so many derivatives at most. `tiles` outlives the object.
  TileRows(Tiles* tiles, int num_joints, int most_derivatives);

  /// The residual and the derivatives of `columns` at the parameters of
  /// `constants`.
  void Evaluate(const kernel::Constants& constants,
                const kernel::Columns& columns, std::int64_t tile);

  // Of the last tile:
  const Tile& tile() const { return tile_; }
  int height() const { return RowsOf(tile_.kind); }
  /// Doubles from one column to the next.
  std::size_t stride() const {
    return static_cast<std::size_t>(height()) * kTile;
  }
  /// Column by column, the residual last; in each column kTile numbers for each
  /// row.
  double* rows() { return rows_.get(); }
  double* residual() { return rows() + stride() * num_derivatives(); }
  /// Squared norms of errors in lengths (m^2).
  const double* lengths() const { return lengths_.get(); }
  int num_derivatives() const { return num_derivatives_; }

 private:
  void ApplyWhiteners(std::int64_t tile);

  Tiles& tiles_;
  int num_derivatives_ = 0;
  Tile tile_;
  AlignedDoubles arrays_;  // of a tile not cached
  AlignedDoubles scratch_;
  AlignedDoubles rows_;
  AlignedDoubles lengths_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_KERNEL_TILE_ROWS_H_
