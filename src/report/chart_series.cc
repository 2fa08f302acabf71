#include "src/report/chart_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace alidade::internal {
namespace {

// Black last: it is the colour of text.
constexpr std::array<std::string_view, 7> kColours = {
    "#0072b2", "#d55e00", "#009e73", "#cc79a7",
    "#e69f00", "#56b4e9", "#000000"};
constexpr std::array<std::string_view, 3> kDashes = {"", "7 4", "2 3"};

constexpr double kLineWidth = 2.0;
constexpr double kRimWidth = 1.6;
constexpr double kMarkerRadius = 4.0;
constexpr double kOpenMarkerRadius = 5.5;
constexpr double kSmallMarkerRadius = 1.5;
constexpr double kLegendKeyLength = 28.0;
// More points than this along a line are thinned, more markers are drawn
// small, more stems lose their heads.
constexpr std::size_t kManyLinePoints = 2000;
constexpr std::size_t kManyMarkers = 300;
constexpr std::size_t kManyStems = 120;
// Where markers are many, one is kept in each cell of this many pixels.
constexpr double kMarkerCell = 2.0;
constexpr int kSamplesPerSegment = 8;

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

std::string MarkerPath(MarkerStyle style, SvgPoint centre, double radius) {
  switch (style) {
    case MarkerStyle::kNone:
      return "";
    case MarkerStyle::kSquare:
      return SquarePath(centre, 0.85 * radius);
    case MarkerStyle::kTriangle:
      return TrianglePath(centre, 1.3 * radius);
    case MarkerStyle::kDot:
    case MarkerStyle::kStem:
      return CirclePath(centre, radius);
  }
  return "";
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

std::vector<SvgPoint> MarkerPoints(const std::vector<PixelRun>& runs) {
  const bool many = NumPoints(runs) > kManyLinePoints;
  std::vector<SvgPoint> points;
  std::set<std::pair<int, int>> taken;
  for (const PixelRun& run : runs) {
    for (const SvgPoint point : run) {
      const std::pair<int, int> cell = {
          static_cast<int>(point.x / kMarkerCell),
          static_cast<int>(point.y / kMarkerCell)};
      if (!many || taken.insert(cell).second) points.push_back(point);
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
  svg->Outline(path, {look.colour, kLineWidth, look.dashes});
}

void DrawMarkers(SvgWriter* svg, MarkerStyle style, const SeriesLook& look,
                 const std::vector<SvgPoint>& points) {
  const bool many = points.size() > kManyMarkers;
  const bool open = look.marker_fill == "none";
  std::string path;
  for (const SvgPoint point : points) {
    path += many ? SquarePath(point, kSmallMarkerRadius)
                 : MarkerPath(style, point,
                              open ? kOpenMarkerRadius : kMarkerRadius);
  }
  if (many) {
    svg->Fill(path, look.colour);
  } else {
    svg->Marker(path, look.marker_fill, {look.colour, kRimWidth});
  }
}

void DrawStems(SvgWriter* svg, const SeriesLook& look, const PlotArea& plot,
               const std::vector<PixelRun>& runs) {
  const double base = BaseLine(plot);
  const auto count = static_cast<double>(NumPoints(runs));
  const bool heads = NumPoints(runs) <= kManyStems;
  const double width =
      heads ? kLineWidth : std::max(1.0, 0.6 * plot.box.width / count);
  std::string path;
  std::vector<SvgPoint> points;
  for (const PixelRun& run : runs) {
    for (const SvgPoint point : ThinLine(run)) {
      path += At('M', {point.x, base}) + "V" + SvgNumber(point.y);
      points.push_back(point);
    }
  }
  svg->Outline(path, {look.colour, width});
  if (heads) DrawMarkers(svg, MarkerStyle::kStem, look, points);
}

void AddSegment(SvgPoint from, SvgPoint to, std::vector<SvgPoint>* samples) {
  for (int i = 0; i <= kSamplesPerSegment; ++i) {
    const double t = static_cast<double>(i) / kSamplesPerSegment;
    samples->push_back(
        {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
  }
}

}  // namespace

SeriesLook LookOf(std::size_t index) {
  const std::string_view colour = kColours[index % kColours.size()];
  return {colour, index == 0 ? colour : "none",
          kDashes[index % kDashes.size()]};
}

std::vector<PixelRun> PixelRuns(const ChartAxis& x, const ChartAxis& y,
                                const ChartSeries& series,
                                const PlotArea& plot) {
  std::vector<PixelRun> runs;
  bool in_run = false;
  const std::size_t size = std::min(series.x.size(), series.y.size());
  for (std::size_t i = 0; i < size; ++i) {
    if (!IsDrawable(x, series.x[i]) || !IsDrawable(y, series.y[i])) {
      in_run = false;
      continue;
    }
    if (!in_run) runs.emplace_back();
    in_run = true;
    runs.back().push_back(plot.At(series.x[i], series.y[i]));
  }
  return runs;
}

void DrawSeries(SvgWriter* svg, const ChartSeries& series,
                const SeriesLook& look, const PlotArea& plot,
                const std::vector<PixelRun>& runs) {
  if (runs.empty()) return;
  if (series.marker == MarkerStyle::kStem) {
    DrawStems(svg, look, plot, runs);
    return;
  }
  if (series.line) DrawLines(svg, look, runs);
  if (series.marker != MarkerStyle::kNone) {
    DrawMarkers(svg, series.marker, look, MarkerPoints(runs));
  }
}

void DrawLegendKey(SvgWriter* svg, const ChartSeries& series,
                   const SeriesLook& look, SvgPoint centre) {
  const double half = kLegendKeyLength / 2.0;
  if (series.line && series.marker != MarkerStyle::kStem) {
    DrawLines(svg, look,
              {{{centre.x - half, centre.y}, {centre.x + half, centre.y}}});
  }
  if (series.marker != MarkerStyle::kNone) {
    DrawMarkers(svg, series.marker, look, {centre});
  }
}

std::vector<SvgPoint> InkSamples(const ChartSeries& series,
                                 const PlotArea& plot,
                                 const std::vector<PixelRun>& runs) {
  std::vector<SvgPoint> samples;
  const double base = BaseLine(plot);
  for (const PixelRun& run : runs) {
    const PixelRun thin = ThinLine(run);
    for (std::size_t i = 0; i < thin.size(); ++i) {
      samples.push_back(thin[i]);
      if (series.marker == MarkerStyle::kStem) {
        AddSegment({thin[i].x, base}, thin[i], &samples);
      } else if (series.line && i > 0) {
        AddSegment(thin[i - 1], thin[i], &samples);
      }
    }
  }
  return samples;
}

}  // namespace alidade::internal
