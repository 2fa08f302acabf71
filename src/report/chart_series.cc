#include "src/report/chart_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace alidade::internal {
namespace {

constexpr std::size_t kNumColours = 7;
constexpr double kMarkerRadius = 4.0;
constexpr double kOpenMarkerRadius = 5.5;
constexpr double kLegendRow = 24.0;
constexpr double kLegendKeyRoom = 38.0;
constexpr double kLegendKeyLength = 28.0;
constexpr double kLegendGap = 24.0;
// More points than this along a line are thinned, more markers are drawn
// small, more stems lose their heads.
constexpr std::size_t kManyLinePoints = 2000;
constexpr std::size_t kManyMarkers = 300;
constexpr std::size_t kManyStems = 120;
constexpr double kStemWidth = 2.0;
// Where markers and tips are many, one is kept in each square of so many
// pixels.
constexpr double kMarkerCell = 2.0;
constexpr std::size_t kManyTips = 150;
constexpr double kTipCell = 20.0;

std::string At(char command, SvgPoint point) {
  return command + SvgNumber(point.x) + " " + SvgNumber(point.y);
}

std::string CirclePath(SvgPoint centre, double radius) {
  const std::string r = SvgNumber(radius);
  const std::string arc = "a" + r + " " + r + " 0 1 ";
  return At('M', {centre.x - radius, centre.y}) + arc + "0 " +
         SvgNumber(2.0 * radius) + " 0" + arc + "0 " +
         SvgNumber(-2.0 * radius) + " 0z";
}

std::string SquarePath(SvgPoint centre, double radius) {
  const std::string side = SvgNumber(2.0 * radius);
  return At('M', {centre.x - radius, centre.y - radius}) + "h" + side + "v" +
         side + "h-" + side + "z";
}

std::string TrianglePath(SvgPoint centre, double radius) {
  const double half = 0.87 * radius;
  return At('M', {centre.x, centre.y - radius}) +
         At('L', {centre.x + half, centre.y + 0.5 * radius}) + "H" +
         SvgNumber(centre.x - half) + "z";
}

std::size_t NumPoints(const std::vector<PixelRun>& runs) {
  std::size_t count = 0;
  for (const PixelRun& run : runs) count += run.size();
  return count;
}

bool SameColumn(SvgPoint a, SvgPoint b) {
  return std::floor(a.x) == std::floor(b.x);
}

// Of each group of neighbours in one pixel column: the first, the extremes in
// the order they come, the last.
PixelRun ThinLine(const PixelRun& run) {
  if (run.size() <= kManyLinePoints) return run;
  PixelRun thin;
  for (auto begin = run.begin(); begin != run.end();) {
    const auto end = std::find_if(begin, run.end(), [begin](SvgPoint point) {
      return !SameColumn(*begin, point);
    });
    const auto extremes = std::minmax_element(
        begin, end, [](SvgPoint a, SvgPoint b) { return a.y < b.y; });
    std::array<PixelRun::const_iterator, 4> kept = {begin, extremes.first,
                                                    extremes.second, end - 1};
    std::sort(kept.begin(), kept.end());
    const auto kept_end = std::unique(kept.begin(), kept.end());
    for (auto it = kept.begin(); it != kept_end; ++it) thin.push_back(**it);
    begin = end;
  }
  return thin;
}

std::vector<SvgPoint> MarkerPoints(const std::vector<PixelRun>& runs,
                                   bool many) {
  std::vector<SvgPoint> points;
  Neighbourhoods taken(kMarkerCell);
  for (const PixelRun& run : runs) {
    for (const SvgPoint point : run) {
      if (!many || taken.IsNew(point)) points.push_back(point);
    }
  }
  return points;
}

double BaseLine(const PlotArea& plot) {
  const double zero = plot.y.Fraction(0.0);
  if (!std::isfinite(zero)) return plot.box.bottom();
  return plot.box.bottom() - std::clamp(zero, 0.0, 1.0) * plot.box.height;
}

// A single point is a line of no length, which round caps make a dot.
void DrawLines(SvgWriter* svg, const SeriesLook& look,
               const std::vector<PixelRun>& runs) {
  std::string path;
  for (const PixelRun& run : runs) {
    const PixelRun thin = ThinLine(run);
    path += At('M', thin.front());
    if (thin.size() == 1) path += "h0";
    for (std::size_t i = 1; i < thin.size(); ++i) path += At('L', thin[i]);
  }
  svg->Path(path, "line " + look.colour);
}

void DrawMarkers(SvgWriter* svg, MarkerStyle style, const SeriesLook& look,
                 const std::vector<SvgPoint>& points, bool many) {
  std::string path;
  for (const SvgPoint point : points) {
    path += many ? At('M', point) + "h0"
                 : MarkerPath(style, point,
                              look.is_open ? kOpenMarkerRadius : kMarkerRadius);
  }
  svg->Path(path, (many           ? "dots "
                   : look.is_open ? "mark "
                                  : "mark full ") +
                      look.colour);
}

void DrawStems(SvgWriter* svg, const SeriesLook& look, const PlotArea& plot,
               const std::vector<PixelRun>& runs) {
  const double base = BaseLine(plot);
  const auto count = static_cast<double>(NumPoints(runs));
  const bool heads = NumPoints(runs) <= kManyStems;
  std::string path;
  std::vector<SvgPoint> points;
  for (const PixelRun& run : runs) {
    for (const SvgPoint point : ThinLine(run)) {
      path += At('M', {point.x, base}) + "V" + SvgNumber(point.y);
      points.push_back(point);
    }
  }
  svg->Path(path, "stem " + look.colour,
            heads ? kStemWidth : std::max(1.0, 0.6 * plot.box.width / count));
  if (heads) DrawMarkers(svg, MarkerStyle::kStem, look, points, false);
}

// Neighbours keep a pixel between them.
void DrawBars(SvgWriter* svg, const ChartSeries& series, const SeriesLook& look,
              const PlotArea& plot, const std::vector<PixelRun>& runs) {
  const double base = BaseLine(plot);
  const double width =
      plot.At(plot.x.lower() + series.bar_width, 0.0).x - plot.box.left - 1.0;
  std::string path;
  for (const PixelRun& run : runs) {
    for (const SvgPoint point : run) {
      path += At('M', {point.x - width / 2.0, base}) + "V" +
              SvgNumber(point.y) + "h" + SvgNumber(width) + "V" +
              SvgNumber(base) + "z";
    }
  }
  svg->Path(path, BarLook(look));
}

void DrawLegendKey(SvgWriter* svg, const ChartSeries& series,
                   const SeriesLook& look, SvgPoint centre) {
  const double half = kLegendKeyLength / 2.0;
  if (series.line && series.marker != MarkerStyle::kStem &&
      series.marker != MarkerStyle::kBar) {
    DrawLines(svg, look,
              {{{centre.x - half, centre.y}, {centre.x + half, centre.y}}});
  }
  if (!series.upper.empty()) {
    constexpr double kHalfBand = 6.0;
    svg->Box(
        {centre.x - half, centre.y - kHalfBand, 2.0 * half, 2.0 * kHalfBand},
        "band " + look.colour);
  }
  if (series.marker == MarkerStyle::kBar) {
    svg->Path(MarkerPath(series.marker, centre, kOpenMarkerRadius),
              BarLook(look));
  } else if (series.marker != MarkerStyle::kNone) {
    DrawMarkers(svg, series.marker, look, {centre}, false);
  }
}

// The points of a band that are one after the other, as a closed path.
std::string BandPath(const PixelRun& lower, const PixelRun& upper) {
  std::string path = At('M', upper.front());
  for (std::size_t i = 1; i < upper.size(); ++i) path += At('L', upper[i]);
  for (auto it = lower.rbegin(); it != lower.rend(); ++it) {
    path += At('L', *it);
  }
  return path + "z";
}

}  // namespace

ChartSeries Markers(const std::string& label, MarkerStyle marker,
                    const std::string& colour) {
  ChartSeries series;
  series.label = label;
  series.line = false;
  series.marker = marker;
  series.colour = colour;
  return series;
}

SeriesLook LookOf(const ChartSeries& series, std::size_t index) {
  const std::string colour = series.colour.empty()
                                 ? "s" + std::to_string(index % kNumColours + 1)
                                 : series.colour;
  return {colour, colour != "s1"};
}

std::string MarkerPath(MarkerStyle style, SvgPoint centre, double radius) {
  switch (style) {
    case MarkerStyle::kNone:
      return "";
    case MarkerStyle::kSquare:
    case MarkerStyle::kBar:
      return SquarePath(centre, 0.85 * radius);
    case MarkerStyle::kTriangle:
      return TrianglePath(centre, 1.3 * radius);
    case MarkerStyle::kDot:
    case MarkerStyle::kStem:
      return CirclePath(centre, radius);
  }
  return "";
}

std::vector<std::size_t> DrawablePoints(const ChartAxis& x, const ChartAxis& y,
                                        const ChartSeries& series) {
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (IsDrawable(x, series.x[i]) && IsDrawable(y, series.y[i])) {
      points.push_back(i);
    }
  }
  return points;
}

std::vector<PixelRun> PixelRuns(const ChartAxis& x, const ChartAxis& y,
                                const ChartSeries& series,
                                const PlotArea& plot) {
  std::vector<PixelRun> runs;
  std::size_t next = 0;
  for (const std::size_t i : DrawablePoints(x, y, series)) {
    if (runs.empty() || i != next) runs.emplace_back();
    runs.back().push_back(plot.At(series.x[i], series.y[i]));
    next = i + 1;
  }
  return runs;
}

std::string BarLook(const SeriesLook& look) {
  return (look.is_open ? "bar hollow " : "bar ") + look.colour;
}

void DrawBand(SvgWriter* svg, const ChartSeries& series, const SeriesLook& look,
              const PlotArea& plot) {
  std::string path;
  PixelRun lower;
  PixelRun upper;
  const auto finish = [&] {
    if (upper.size() > 1) path += BandPath(lower, upper);
    lower.clear();
    upper.clear();
  };
  const auto at = [&](double x, double y) {
    return plot.At(x, std::clamp(y, plot.y.lower(), plot.y.upper()));
  };
  for (std::size_t i = 0; i < series.upper.size(); ++i) {
    if (!(series.lower[i] <= series.upper[i])) {
      finish();
      continue;
    }
    lower.push_back(at(series.x[i], series.lower[i]));
    upper.push_back(at(series.x[i], series.upper[i]));
  }
  finish();
  if (!path.empty()) svg->Path(path, "band " + look.colour);
}

void DrawSeries(SvgWriter* svg, const ChartSeries& series,
                const SeriesLook& look, const PlotArea& plot,
                const std::vector<PixelRun>& runs) {
  if (runs.empty()) return;
  if (series.marker == MarkerStyle::kStem) {
    DrawStems(svg, look, plot, runs);
    return;
  }
  if (series.marker == MarkerStyle::kBar) {
    DrawBars(svg, series, look, plot, runs);
    return;
  }
  if (series.line) DrawLines(svg, look, runs);
  if (series.marker != MarkerStyle::kNone) {
    const bool many = NumPoints(runs) > kManyMarkers;
    DrawMarkers(svg, series.marker, look, MarkerPoints(runs, many), many);
  }
}

void DrawTips(SvgWriter* svg, const ChartAxis& x, const ChartAxis& y,
              const ChartSeries& series, const PlotArea& plot) {
  if (!series.tip) return;
  std::vector<PointWithTip> points;
  for (const std::size_t i : DrawablePoints(x, y, series)) {
    points.push_back({plot.At(series.x[i], series.y[i]), series.y[i], i});
  }
  if (points.size() > kManyTips) {
    return DrawLargestTips(svg, points, series.tip);
  }
  for (const PointWithTip& point : points) {
    svg->Tip(point.at, series.tip(point.index));
  }
}

void DrawLargestTips(SvgWriter* svg, std::vector<PointWithTip> points,
                     const std::function<std::string(std::size_t)>& tip) {
  std::stable_sort(points.begin(), points.end(),
                   [](const PointWithTip& a, const PointWithTip& b) {
                     return a.value > b.value;
                   });
  Neighbourhoods taken(kTipCell);
  for (const PointWithTip& point : points) {
    if (taken.IsNew(point.at)) svg->Tip(point.at, tip(point.index));
  }
}

double DrawLegend(SvgWriter* svg, const ChartLayout& layout,
                  const std::vector<ChartSeries>& series, double top) {
  double x = layout.margin;
  double bottom = top;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series[i].label.empty()) continue;
    const double width =
        kLegendKeyRoom + SvgTextWidth(series[i].label, kTickSize);
    if (bottom == top || x + width > layout.width - layout.margin) {
      x = layout.margin;
      bottom += kLegendRow;
    }
    const double y = bottom - kLegendRow / 2.0;
    DrawLegendKey(svg, series[i], LookOf(series[i], i), {x + 14.0, y});
    svg->Text({x + kLegendKeyRoom, y + 0.36 * kTickSize}, series[i].label, "");
    x += width + kLegendGap;
  }
  return bottom;
}

bool Neighbourhoods::IsNew(SvgPoint at) {
  const auto column = static_cast<std::size_t>(std::max(0.0, at.x) / side_);
  const auto row = static_cast<std::size_t>(std::max(0.0, at.y) / side_);
  if (row >= taken_.size()) taken_.resize(row + 1);
  if (column >= taken_[row].size()) taken_[row].resize(column + 1);
  const bool is_new = !taken_[row][column];
  taken_[row][column] = true;
  return is_new;
}

}  // namespace alidade::internal
