#ifndef ALIDADE_SRC_REPORT_CHART_SERIES_H_
#define ALIDADE_SRC_REPORT_CHART_SERIES_H_

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "src/report/chart_frame.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

enum class MarkerStyle { kNone, kDot, kSquare, kTriangle, kStem, kBar };

/// One curve or cloud. Points that are not finite, not positive on a
/// logarithmic axis, or outside a given range are left out, and the line is
/// broken there. kStem and kBar stand on zero (or on the bottom of the chart)
/// and draw no line between points.
struct ChartSeries {
  std::string label;  ///< legend; empty = not listed
  std::vector<double> x;
  std::vector<double> y;
  /// A band about the line, one entry per point; empty: none.
  std::vector<double> lower = {};
  std::vector<double> upper = {};
  bool line = true;
  MarkerStyle marker = MarkerStyle::kNone;
  double bar_width = 1.0;  ///< of kBar, in units of x
  /// "s0" (grey), "s1" to "s7"; empty = by its place among the series. "s1
  /// dashed" and "s1 solid" say how its line is drawn, whatever the colour.
  std::string colour;
  /// What is said of a point under the pointer; nothing where it is empty.
  std::function<std::string(std::size_t)> tip;
};

/// One without points yet, of markers alone.
ChartSeries Markers(const std::string& label, MarkerStyle marker,
                    const std::string& colour = "");

/// How a series is drawn: its colour, and full markers for the first colour,
/// open ones for others, so that those below show through.
struct SeriesLook {
  std::string colour;
  bool is_open = false;
};
SeriesLook LookOf(const ChartSeries& series, std::size_t index);

/// A path that draws one marker.
std::string MarkerPath(MarkerStyle style, SvgPoint centre, double radius);

/// Those points of a series that have a place on the axes, by their numbers.
std::vector<std::size_t> DrawablePoints(const ChartAxis& x, const ChartAxis& y,
                                        const ChartSeries& series);

/// Points of a series in pixels, without those that have no place on the axes;
/// a new run begins behind each of those.
using PixelRun = std::vector<SvgPoint>;
std::vector<PixelRun> PixelRuns(const ChartAxis& x, const ChartAxis& y,
                                const ChartSeries& series,
                                const PlotArea& plot);

/// Fills the band of a series, cut where the plot ends.
void DrawBand(SvgWriter* svg, const ChartSeries& series, const SeriesLook& look,
              const PlotArea& plot);

/// The look of a bar: those that are not of the first colour are hollow.
std::string BarLook(const SeriesLook& look);

/// Draws line and markers, thinned to what pixels can show: of a million points
/// the first, last, lowest and highest of each pixel column stay.
void DrawSeries(SvgWriter* svg, const ChartSeries& series,
                const SeriesLook& look, const PlotArea& plot,
                const std::vector<PixelRun>& runs);

/// What a tip is about, and its place.
struct PointWithTip {
  SvgPoint at;
  double value = 0.0;
  std::size_t index = 0;
};

/// The tip of the largest value in each neighbourhood.
void DrawLargestTips(SvgWriter* svg, std::vector<PointWithTip> points,
                     const std::function<std::string(std::size_t)>& tip);

/// The tips of a series; where points are many, that of the largest value in
/// each neighbourhood.
void DrawTips(SvgWriter* svg, const ChartAxis& x, const ChartAxis& y,
              const ChartSeries& series, const PlotArea& plot);

/// A legend from `top` downwards, above the plot, so that it never covers data.
/// Returns the y below it.
double DrawLegend(SvgWriter* svg, const ChartLayout& layout,
                  const std::vector<ChartSeries>& series, double top);

/// One thing for each neighbourhood of the plot, of several the first:
/// whether `at` is in a square of `side` pixels that no call has seen.
class Neighbourhoods {
 public:
  explicit Neighbourhoods(double side) : side_(side) {}
  bool IsNew(SvgPoint at);

 private:
  double side_;
  std::vector<std::vector<bool>> taken_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CHART_SERIES_H_
