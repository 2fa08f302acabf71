#include "src/report/map_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace alidade::internal {
namespace {

constexpr std::size_t kFewSamples = 400;
constexpr double kLargestSquare = 14.0;
constexpr double kSmallestSquare = 2.0;
// More samples than this are thinned to one for each cell of this side; the
// largest value there stays.
constexpr std::size_t kManySamples = 20000;
constexpr double kThinnedCell = 3.0;
// A raster's cells in mean spacings of the samples.
constexpr double kCellSpacings = 0.5;
// Samples within this many mean spacings decide whether a cell lies between
// them. It bridges the gaps between rows that are this much sparser than dense.
constexpr double kSearchSpacings = 4.0;
// Directions are told apart by sector. Samples surround a cell where no more
// neighbouring sectors than this are empty, a little less than half of them.
constexpr int kNumSectors = 64;
constexpr int kWidestGap = 30;

using CellIndex = std::pair<int, int>;

CellIndex IndexOf(SvgPoint point, double side) {
  return {static_cast<int>(std::floor(point.x / side)),
          static_cast<int>(std::floor(point.y / side))};
}

std::vector<MapSample> Thin(const std::vector<MapSample>& samples) {
  std::map<CellIndex, MapSample> kept;
  for (const MapSample& sample : samples) {
    MapSample& there =
        kept.emplace(IndexOf(sample.at, kThinnedCell), sample).first->second;
    if (sample.value > there.value) there = sample;
  }
  std::vector<MapSample> thin;
  thin.reserve(kept.size());
  for (const auto& entry : kept) thin.push_back(entry.second);
  return thin;
}

// Mean distance between neighbours, from the area that the samples cover,
// counted in squares of about nine samples each.
double MeanSpacing(const std::vector<MapSample>& samples, const SvgBox& box) {
  const auto count = static_cast<double>(samples.size());
  const double side = 3.0 * std::sqrt(box.width * box.height / count);
  std::set<CellIndex> taken;
  for (const MapSample& sample : samples) {
    taken.insert(IndexOf(sample.at, side));
  }
  return side * std::sqrt(static_cast<double>(taken.size()) / count);
}

double SquaredDistance(SvgPoint a, SvgPoint b) {
  const double x = a.x - b.x;
  const double y = a.y - b.y;
  return x * x + y * y;
}

// The samples sorted into squares of the search radius, so that those near a
// point are quickly found.
class SampleGrid {
 public:
  SampleGrid(const std::vector<MapSample>& samples, const SvgBox& box,
             double radius)
      : origin_{box.left - 2.0 * radius, box.top - 2.0 * radius},
        radius_(radius),
        columns_(static_cast<int>(box.width / radius) + 5),
        rows_(static_cast<int>(box.height / radius) + 5),
        squares_(static_cast<std::size_t>(columns_) *
                 static_cast<std::size_t>(rows_)) {
    for (const MapSample& sample : samples) {
      const CellIndex index = Index(sample.at);
      squares_[Place(index.first, index.second)].push_back(sample);
    }
  }

  // The samples within the radius. @pre the box holds `point`.
  void FindNear(SvgPoint point, std::vector<MapSample>* near) const {
    near->clear();
    const CellIndex middle = Index(point);
    for (int i = middle.first - 1; i <= middle.first + 1; ++i) {
      for (int j = middle.second - 1; j <= middle.second + 1; ++j) {
        for (const MapSample& sample : squares_[Place(i, j)]) {
          const double squared = SquaredDistance(point, sample.at);
          if (squared <= radius_ * radius_) near->push_back(sample);
        }
      }
    }
  }

 private:
  CellIndex Index(SvgPoint point) const {
    return IndexOf({point.x - origin_.x, point.y - origin_.y}, radius_);
  }

  std::size_t Place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  SvgPoint origin_;
  double radius_;
  int columns_;
  int rows_;
  std::vector<std::vector<MapSample>> squares_;
};

// The direction of a vector as a number from 0 to 4 that grows with its angle:
// opposite directions differ by 2, as with the angle by pi.
double Turn(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0.0) return 0.0;
  if (y >= 0.0) return 1.0 - x / sum;
  return 3.0 + x / sum;
}

bool IsSurrounded(SvgPoint point, const std::vector<MapSample>& near) {
  std::array<bool, kNumSectors> taken = {};
  for (const MapSample& sample : near) {
    const double turn = Turn(sample.at.x - point.x, sample.at.y - point.y);
    const int sector = static_cast<int>(turn * (kNumSectors / 4.0));
    taken[static_cast<std::size_t>(sector % kNumSectors)] = true;
  }
  // Round twice, so that a run across the first sector is seen whole.
  int empty_run = 0;
  for (int i = 0; i < 2 * kNumSectors; ++i) {
    empty_run =
        taken[static_cast<std::size_t>(i % kNumSectors)] ? 0 : empty_run + 1;
    if (empty_run > kWidestGap) return false;
  }
  return true;
}

const MapSample& Nearest(SvgPoint point, const std::vector<MapSample>& near) {
  return *std::min_element(near.begin(), near.end(),
                           [point](const MapSample& a, const MapSample& b) {
                             return SquaredDistance(point, a.at) <
                                    SquaredDistance(point, b.at);
                           });
}

bool Holds(SvgPoint middle, double side, SvgPoint point) {
  return std::abs(point.x - middle.x) <= side / 2.0 &&
         std::abs(point.y - middle.y) <= side / 2.0;
}

// Whole pixels, so that renderers draw sharp edges.
std::vector<MapSample> FillRaster(const SampleGrid& grid, const SvgBox& box,
                                  double side) {
  std::vector<MapSample> cells;
  std::vector<MapSample> near;
  const double left = std::floor(box.left);
  const double top = std::floor(box.top);
  const int columns = static_cast<int>((box.right() - left) / side) + 1;
  const int rows = static_cast<int>((box.bottom() - top) / side) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const SvgPoint middle{left + (column + 0.5) * side,
                            top + (row + 0.5) * side};
      grid.FindNear(middle, &near);
      if (near.empty()) continue;
      const MapSample& nearest = Nearest(middle, near);
      if (Holds(middle, side, nearest.at) || IsSurrounded(middle, near)) {
        cells.push_back({middle, nearest.value});
      }
    }
  }
  return cells;
}

}  // namespace

MapCells MakeMapCells(const std::vector<MapSample>& samples,
                      const SvgBox& box) {
  if (samples.size() < kFewSamples) {
    const double side =
        std::clamp(MeanSpacing(samples, box), kSmallestSquare, kLargestSquare);
    return {samples, side};
  }
  const std::vector<MapSample> kept =
      samples.size() > kManySamples ? Thin(samples) : samples;
  const double spacing = MeanSpacing(kept, box);
  const double side = std::clamp(std::round(kCellSpacings * spacing),
                                 kSmallestSquare, kLargestSquare);
  const SampleGrid grid(kept, box, kSearchSpacings * std::max(spacing, side));
  return {FillRaster(grid, box, side), side};
}

}  // namespace alidade::internal
