#include "src/kernel/observation_rows.h"

#include <algorithm>

#include "src/common/parallel.h"
#include "src/kernel/kernel.h"
#include "src/kernel/tile_rows.h"
#include "src/kernel/tiles.h"

namespace alidade::internal {
namespace {

// Copies one lane of a tile to `out`, rows of the observation by columns.
void CopyLane(TileRows* rows, int lane, Eigen::MatrixXd* out) {
  const int width = rows->num_derivatives() + 1;
  const int height = rows->height();
  const auto stride = rows->stride();
  out->resize(height, width);
  double* to = out->data();
  for (int column = 0; column < width; ++column) {
    const double* from = rows->rows() + column * stride + lane;
    for (int row = 0; row < height; ++row, from += kTile) *to++ = *from;
  }
}

}  // namespace

std::vector<Eigen::Index> FirstObservations(const Dataset& data) {
  std::vector<Eigen::Index> first = {0};
  for (const ObservationBlock& block : data.blocks) {
    first.push_back(first.back() + block.size());
  }
  return first;
}

void ForEachObservation(const MeasurementModel& model,
                        const Eigen::VectorXd& values, const Dataset& data,
                        const std::vector<int>& columns,
                        const VisitRows& visit) {
  Tiles tiles(model.nominal(), data, 0);
  const kernel::Columns wanted(model.layout(), columns);
  kernel::Constants constants;
  kernel::ComputeConstants(model, values, &constants);
  const std::vector<Eigen::Index> first = FirstObservations(data);
  const std::int64_t part_size =
      std::max<std::int64_t>(1, (tiles.size() + kRowParts - 1) / kRowParts);
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    TileRows rows(&tiles, model.layout().num_joints(),
                  static_cast<int>(columns.size()));
    Eigen::MatrixXd out;
    for (std::int64_t tile = begin; tile < end; ++tile) {
      rows.Evaluate(constants, wanted, tile);
      for (int lane = 0; lane < rows.tile().count; ++lane) {
        CopyLane(&rows, lane, &out);
        visit(static_cast<int>(begin / part_size),
              first[rows.tile().block] + tiles.Observation(tile, lane), out);
      }
    }
  };
  ParallelFor(model.num_threads(), tiles.size(), part_size, work);
}

}  // namespace alidade::internal
