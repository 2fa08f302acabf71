#include "src/report/map_cells.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <set>
#include <utility>

namespace alidade::internal {
namespace {

constexpr std::size_t kFewSamples = 400;
constexpr double kLargestSquare = 14.0;
constexpr double kSmallestSquare = 2.0;
// A raster's cells in mean spacings of the samples.
constexpr double kCellSpacings = 0.5;
// Gaps between samples are filled where they are at most twice as wide, in mean
// spacings.
constexpr double kGapSpacings = 2.0;

// Mean distance between neighbours, from the area that the samples cover,
// counted in squares of about nine samples each.
double MeanSpacing(const std::vector<MapSample>& samples, const SvgBox& box) {
  const auto count = static_cast<double>(samples.size());
  const double side = 3.0 * std::sqrt(box.width * box.height / count);
  std::set<std::pair<double, double>> taken;
  for (const MapSample& sample : samples) {
    taken.emplace(std::floor(sample.at.x / side),
                  std::floor(sample.at.y / side));
  }
  return side * std::sqrt(static_cast<double>(taken.size()) / count);
}

// Cells over a box with a rim of empty ones, by rows.
class Raster {
 public:
  Raster(const SvgBox& box, double side, int rim)
      : side_(side),
        // Whole pixels, so that renderers draw sharp edges.
        left_(std::floor(box.left) - rim * side),
        top_(std::floor(box.top) - rim * side),
        columns_(static_cast<int>(box.width / side) + 2 * rim + 2),
        rows_(static_cast<int>(box.height / side) + 2 * rim + 2) {}

  int size() const { return columns_ * rows_; }
  int CellOf(SvgPoint point) const {
    return static_cast<int>((point.y - top_) / side_) * columns_ +
           static_cast<int>((point.x - left_) / side_);
  }
  SvgPoint Middle(int cell) const {
    const int column = cell % columns_;
    const int row = cell / columns_;
    return {left_ + (column + 0.5) * side_, top_ + (row + 0.5) * side_};
  }

  // The nearest of `seeds` for each cell that is at most `reach` steps off; -1
  // for all others. Every other step may be diagonal, so that what is near is
  // an octagon.
  std::vector<int> Nearest(const std::vector<int>& seeds, int reach) const {
    std::vector<int> nearest(static_cast<std::size_t>(size()), -1);
    std::deque<std::pair<int, int>> front;  // a cell, and how far off it is
    for (const int seed : seeds) {
      nearest[seed] = seed;
      front.emplace_back(seed, 0);
    }
    for (; !front.empty(); front.pop_front()) {
      const auto [cell, distance] = front.front();
      if (distance == reach) continue;
      const int column = cell % columns_;
      for (int step = 0; step < 9; ++step) {
        const int next_column = column + step % 3 - 1;
        const int next = cell + (step / 3 - 1) * columns_ + step % 3 - 1;
        const bool is_diagonal = step % 2 == 0;
        if ((is_diagonal && distance % 2 == 0) || next_column < 0 ||
            next_column >= columns_ || next < 0 || next >= size() ||
            nearest[next] >= 0) {
          continue;
        }
        nearest[next] = nearest[cell];
        front.emplace_back(next, distance + 1);
      }
    }
    return nearest;
  }

 private:
  double side_;
  double left_;
  double top_;
  int columns_;
  int rows_;
};

// Closes the gaps between samples: grows the area that they cover and takes the
// same again off its edge.
std::vector<MapSample> FillRaster(const std::vector<MapSample>& samples,
                                  const SvgBox& box, double side, int reach) {
  const Raster raster(box, side, reach + 1);
  std::vector<double> values(static_cast<std::size_t>(raster.size()),
                             -std::numeric_limits<double>::infinity());
  for (const MapSample& sample : samples) {
    double& value = values[raster.CellOf(sample.at)];
    value = std::max(value, sample.value);
  }
  std::vector<int> seeds;
  std::vector<int> outside;
  for (int cell = 0; cell < raster.size(); ++cell) {
    if (std::isfinite(values[cell])) seeds.push_back(cell);
  }
  const std::vector<int> nearest = raster.Nearest(seeds, reach);
  for (int cell = 0; cell < raster.size(); ++cell) {
    if (nearest[cell] < 0) outside.push_back(cell);
  }
  const std::vector<int> edge = raster.Nearest(outside, reach);
  std::vector<MapSample> cells;
  for (int cell = 0; cell < raster.size(); ++cell) {
    if (edge[cell] >= 0 && !std::isfinite(values[cell])) continue;
    cells.push_back({raster.Middle(cell), values[nearest[cell]]});
  }
  return cells;
}

}  // namespace

MapCells MakeMapCells(const std::vector<MapSample>& samples,
                      const SvgBox& box) {
  const double spacing = MeanSpacing(samples, box);
  if (samples.size() < kFewSamples) {
    return {samples, std::clamp(spacing, kSmallestSquare, kLargestSquare)};
  }
  const double side = std::clamp(std::round(kCellSpacings * spacing),
                                 kSmallestSquare, kLargestSquare);
  const int reach = static_cast<int>(
      std::ceil(kGapSpacings * std::max(spacing, side) / side));
  return {FillRaster(samples, box, side, reach), side};
}

}  // namespace alidade::internal
