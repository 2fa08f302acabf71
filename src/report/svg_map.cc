#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/chart_frame.h"
#include "src/report/chart_series.h"
#include "src/report/svg_chart.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

namespace {

// A value at a place of the chart (pixels).
struct MapSample {
  SvgPoint at;
  double value = 0.0;
};

// Squares to paint, all of one size: `at` is the middle.
struct MapCells {
  std::vector<MapSample> cells;
  double side = 0.0;
};

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

// What to paint for samples in `box`. Some hundred samples or more become a
// raster, row by row, over the area that they cover: a cell has the largest of
// the values in it, or that of the nearest cell with a sample. Gaps between
// rows of samples are closed, a few mean spacings wide. Fewer samples stay
// squares of their own, in their own order.
// @pre `box` holds every sample; samples is not empty.
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

constexpr double kMapHeight = 500.0;
constexpr double kMapPageHeight = 340.0;
constexpr double kMapBottomMargin = 56.0;
constexpr int kMapMaxLabels = 7;
constexpr double kBarGap = 24.0;
constexpr double kBarWidth = 18.0;
constexpr double kTickGap = 8.0;
// Odd, so that equal values, which lie in the middle, have one colour.
constexpr int kNumColours = 63;
// Cells reach under their neighbours, so that no seam shows.
constexpr double kCellOverlap = 0.6;

// Viridis (van der Walt, Smith 2015), every ninth part of it: readable by
// colour-blind people and in grey.
struct Rgb {
  double red, green, blue;
};
constexpr std::array<Rgb, 10> kViridis = {{{68, 1, 84},
                                           {72, 40, 120},
                                           {62, 73, 137},
                                           {49, 104, 142},
                                           {38, 130, 142},
                                           {31, 158, 137},
                                           {53, 183, 121},
                                           {110, 206, 88},
                                           {181, 222, 43},
                                           {253, 231, 37}}};

std::string HexByte(double value) {
  constexpr char kDigits[] = "0123456789abcdef";
  const int byte = static_cast<int>(std::lround(value));
  return {kDigits[byte / 16], kDigits[byte % 16]};
}

}  // namespace

std::string MapColour(double fraction) {
  const double place = fraction * (kViridis.size() - 1);
  const auto below =
      std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double t = place - static_cast<double>(below);
  const Rgb& a = kViridis[below];
  const Rgb& b = kViridis[below + 1];
  return "#" + HexByte(a.red + t * (b.red - a.red)) +
         HexByte(a.green + t * (b.green - a.green)) +
         HexByte(a.blue + t * (b.blue - a.blue));
}

namespace {

std::string LevelColour(int level) {
  return MapColour(static_cast<double>(level) / (kNumColours - 1));
}

int LevelOf(const AxisScale& colour, double value) {
  const int level = static_cast<int>(colour.Fraction(value) * kNumColours);
  return std::clamp(level, 0, kNumColours - 1);
}

struct MapPoint {
  double x;
  double y;
  double value;
  std::size_t index;
};

std::vector<MapPoint> DrawablePoints(const MapChart& chart) {
  std::vector<MapPoint> points;
  const std::size_t size =
      std::min({chart.px.size(), chart.py.size(), chart.value.size()});
  for (std::size_t i = 0; i < size; ++i) {
    if (IsDrawable(chart.x, chart.px[i]) && IsDrawable(chart.y, chart.py[i]) &&
        IsDrawable(chart.colour, chart.value[i])) {
      points.push_back({chart.px[i], chart.py[i], chart.value[i], i});
    }
  }
  return points;
}

struct MapExtent {
  ValueRange x;
  ValueRange y;
  ValueRange value;
};

MapExtent ExtentOf(const std::vector<MapPoint>& points) {
  MapExtent extent;
  for (const MapPoint& point : points) {
    extent.x.Include(point.x);
    extent.y.Include(point.y);
    extent.value.Include(point.value);
  }
  return extent;
}

std::string Describe(const MapChart& chart, const MapExtent& extent,
                     std::size_t count) {
  std::string text = chart.subtitle;
  if (!text.empty()) text += ". ";
  text += "Map of " + chart.colour.label + " over " + chart.x.label + " and " +
          chart.y.label + ": " +
          Count(static_cast<std::int64_t>(count), "point");
  if (count == 0) return text + ".";
  return text + " from " + FormatSignificant(extent.value.min, 4) + " to " +
         FormatSignificant(extent.value.max, 4) + ".";
}

// Widens the shorter axis about its middle until a unit has the same length
// in pixels on both.
void Equalize(SvgBox box, ChartAxis* x, ChartAxis* y) {
  const double unit_x = (x->upper - x->lower) / box.width;
  const double unit_y = (y->upper - y->lower) / box.height;
  ChartAxis* axis = unit_x < unit_y ? x : y;
  const double grow = std::max(unit_x, unit_y) / std::min(unit_x, unit_y);
  const double middle = 0.5 * (axis->lower + axis->upper);
  const double half = 0.5 * grow * (axis->upper - axis->lower);
  axis->lower = middle - half;
  axis->upper = middle + half;
}

ChartAxis Ranged(ChartAxis axis, ValueRange data) {
  const AxisScale scale(axis, data, AxisScale::Fit::kPlace, kMapMaxLabels);
  axis.lower = scale.lower();
  axis.upper = scale.upper();
  return axis;
}

PlotArea MakePlot(const MapChart& chart, const MapExtent& extent,
                  const SvgBox& room, const ChartLayout& layout) {
  ChartAxis x = Ranged(chart.x, extent.x);
  ChartAxis y = Ranged(chart.y, extent.y);
  const double left = LeftMargin(
      layout, AxisScale(y, extent.y, AxisScale::Fit::kPlace, kMapMaxLabels));
  const SvgBox box{left, room.top, room.right() - left, room.height};
  if (chart.equal_scale && !x.logarithmic && !y.logarithmic) {
    Equalize(box, &x, &y);
  }
  const int more = layout.medium == FigureMedium::kFile ? 3 : -2;
  return {box,
          AxisScale(x, extent.x, AxisScale::Fit::kPlace, kMapMaxLabels + more),
          AxisScale(y, extent.y, AxisScale::Fit::kPlace, kMapMaxLabels)};
}

std::vector<MapSample> Samples(const std::vector<MapPoint>& points,
                               const PlotArea& plot) {
  std::vector<MapSample> samples;
  samples.reserve(points.size());
  for (const MapPoint& point : points) {
    samples.push_back({plot.At(point.x, point.y), point.value});
  }
  return samples;
}

// Cells of one colour are strokes of one path, neighbours in a row one stroke:
// that keeps the document small.
void DrawCells(SvgWriter* svg, const MapCells& map, const AxisScale& colour) {
  std::array<std::string, kNumColours> paths;
  for (auto first = map.cells.begin(); first != map.cells.end();) {
    const int level = LevelOf(colour, first->value);
    auto last = first;
    for (auto next = first + 1;
         next != map.cells.end() && LevelOf(colour, next->value) == level &&
         next->at.y == first->at.y && next->at.x == last->at.x + map.side;
         ++next) {
      last = next;
    }
    paths[static_cast<std::size_t>(level)] +=
        "M" + SvgNumber(first->at.x - map.side / 2.0) + " " +
        SvgNumber(first->at.y) + "h" +
        SvgNumber(last->at.x - first->at.x + map.side + kCellOverlap);
    first = last + 1;
  }
  for (int level = 0; level < kNumColours; ++level) {
    const std::string& path = paths[static_cast<std::size_t>(level)];
    if (path.empty()) continue;
    svg->Strokes(path, LevelColour(level), map.side + kCellOverlap);
  }
}

// Links as a line, the base as a foot below its first corner.
void DrawOutline(SvgWriter* svg, const MapChart& chart, const PlotArea& plot) {
  if (chart.outline.empty()) return;
  std::string path;
  for (const auto& [x, y] : chart.outline) {
    const SvgPoint at = plot.At(x, y);
    path +=
        (path.empty() ? "M" : "L") + SvgNumber(at.x) + " " + SvgNumber(at.y);
  }
  if (chart.outline.size() > 1) {
    svg->Path(path, "halo", 7.0);
    svg->Path(path, "link", 3.0);
  }
  const auto& [x, y] = chart.outline.front();
  const SvgPoint base = plot.At(x, y);
  svg->Path("M" + SvgNumber(base.x - 7.0) + " " + SvgNumber(base.y + 5.0) +
                "h14v-10h-14z",
            "joint");
  svg->Text({base.x + 11.0, base.y + 4.0}, "base", "small halo");
}

void DrawMarked(SvgWriter* svg, const MapChart& chart, const PlotArea& plot) {
  if (chart.marked_name.empty()) return;
  const SvgPoint at = plot.At(chart.marked.first, chart.marked.second);
  const std::string ring = "M" + SvgNumber(at.x - 7.0) + " " + SvgNumber(at.y) +
                           "a7 7 0 1 0 14 0a7 7 0 1 0-14 0z";
  svg->Path(ring, "halo", 5.0);
  svg->Path(ring, "mark s7", 2.0);
  svg->Text({at.x + 11.0, at.y + 4.0}, chart.marked_name, "small halo");
}

double BarRoom(const AxisScale& colour) {
  return kBarGap + kBarWidth + 2.0 * kTickGap + TickLabelWidth(colour) +
         1.6 * kLabelSize;
}

void DrawBar(SvgWriter* svg, const AxisScale& colour, const SvgBox& bar) {
  const double height = bar.height / kNumColours;
  for (int level = 0; level < kNumColours; ++level) {
    // Each overlaps the one above it, so that no seam shows.
    const double overlap = level == kNumColours - 1 ? 0.0 : 1.0;
    const double y = bar.bottom() - (level + 0.5) * height - overlap / 2.0;
    svg->Strokes("M" + SvgNumber(bar.left) + " " + SvgNumber(y) + "h" +
                     SvgNumber(bar.width),
                 LevelColour(level), height + overlap);
  }
  for (const AxisTick& tick : colour.ticks()) {
    const double y = bar.bottom() - tick.fraction * bar.height;
    svg->Line({bar.right(), y}, {bar.right() + 4.0, y}, "axis");
    if (tick.label.empty()) continue;
    svg->Text({bar.right() + kTickGap, y + 0.36 * kTickSize}, tick.label,
              "tick");
  }
  svg->Text(
      {bar.right() + 2.0 * kTickGap + TickLabelWidth(colour) + 0.9 * kLabelSize,
       bar.top + bar.height / 2.0},
      colour.label(), "label middle", -90.0);
}

// Squares of the samples' own cells, or what MakeMapCells makes of them.
MapCells CellsOf(const MapChart& chart, const std::vector<MapPoint>& points,
                 const PlotArea& plot) {
  std::vector<MapSample> samples = Samples(points, plot);
  if (chart.cell_size == 0.0) return MakeMapCells(samples, plot.box);
  const double side =
      plot.At(plot.x.lower() + chart.cell_size, plot.y.lower()).x -
      plot.box.left;
  return {std::move(samples), side};
}

void DrawMap(SvgWriter* svg, const MapChart& chart,
             const std::vector<MapPoint>& points, const ChartLayout& layout,
             const SvgBox& room) {
  MapExtent extent = ExtentOf(points);
  for (const auto& [x, y] : chart.outline) {
    extent.x.Include(x);
    extent.y.Include(y);
  }
  const AxisScale colour(chart.colour, extent.value, AxisScale::Fit::kColour,
                         kMapMaxLabels);
  SvgBox plot_room = room;
  plot_room.width -= BarRoom(colour);
  const PlotArea plot = MakePlot(chart, extent, plot_room, layout);
  DrawAxes(svg, plot);
  DrawCells(svg, CellsOf(chart, points, plot), colour);
  DrawOutline(svg, chart, plot);
  DrawMarked(svg, chart, plot);
  if (chart.tip) {
    std::vector<PointWithTip> tips;
    for (const MapPoint& point : points) {
      tips.push_back({plot.At(point.x, point.y), point.value, point.index});
    }
    DrawLargestTips(svg, std::move(tips), chart.tip);
  }
  DrawBar(svg, colour,
          {plot.box.right() + kBarGap, room.top, kBarWidth, plot.box.height});
}

}  // namespace

std::string RenderSvg(const MapChart& chart, FigureMedium medium) {
  const std::vector<MapPoint> points = DrawablePoints(chart);
  const ChartLayout layout = LayoutOf(medium);
  const double height =
      medium == FigureMedium::kFile ? kMapHeight : kMapPageHeight;
  SvgWriter svg({layout.width, height}, chart.title,
                Describe(chart, ExtentOf(points), points.size()), medium);
  const double top =
      DrawHeader(&svg, layout, chart.title, chart.subtitle) + 8.0;
  const SvgBox room{layout.margin, top, layout.width - 2.0 * layout.margin,
                    height - kMapBottomMargin - top};
  if (points.empty()) {
    DrawNoData(&svg,
               {room.left, top, room.width, height - layout.margin - top});
  } else {
    DrawMap(&svg, chart, points, layout, room);
  }
  return svg.Finish();
}

}  // namespace alidade::internal
