#include "src/kernel/tile_rows.h"

#include <algorithm>

namespace alidade::internal {
namespace {

int HighestRows(const Dataset& data) {
  int rows = 1;
  for (const ObservationBlock& block : data.blocks) {
    rows = std::max(rows, block.rows_each());
  }
  return rows;
}

}  // namespace

TileRows::TileRows(Tiles* tiles, int num_joints, int most_derivatives)
    : tiles_(*tiles),
      arrays_(AllocateDoubles(tiles->scratch_size())),
      scratch_(AllocateDoubles(kernel::ScratchSize(num_joints))),
      rows_(AllocateDoubles(
          static_cast<std::size_t>(HighestRows(tiles->data())) * kTile *
          (static_cast<std::size_t>(most_derivatives) + 1))),
      lengths_(AllocateDoubles(kTile)) {}

void TileRows::Evaluate(const kernel::Constants& constants,
                        const kernel::Columns& columns, std::int64_t tile) {
  num_derivatives_ = columns.num_derivatives();
  tile_ = tiles_.Get(tile, arrays_.get());
  kernel::EvaluateTile(constants, columns, tile_, scratch_.get(), rows_.get(),
                       lengths_.get());
  if (tiles_.scale() == RowScale::kWhitened &&
      !tiles_.data().blocks[tile_.block].whiteners.empty()) {
    ApplyWhiteners(tile);
  }
}

void TileRows::ApplyWhiteners(std::int64_t tile) {
  const ObservationBlock& block = tiles_.data().blocks[tile_.block];
  Eigen::Matrix<double, 6, 1> raw;
  for (int lane = 0; lane < tile_.count; ++lane) {
    const Eigen::MatrixXd& whitener =
        block.whiteners[tiles_.Observation(tile, lane)];
    if (whitener.size() == 0) continue;
    for (int column = 0; column <= num_derivatives(); ++column) {
      double* const first = rows() + stride() * column + lane;
      for (int row = 0; row < height(); ++row) {
        raw[row] = first[std::ptrdiff_t{row} * kTile];
      }
      for (int row = 0; row < height(); ++row) {
        first[std::ptrdiff_t{row} * kTile] =
            whitener.row(row).dot(raw.head(height()));
      }
    }
  }
}

}  // namespace alidade::internal
