#ifndef ALIDADE_SRC_REPORT_CHART_SERIES_H_
#define ALIDADE_SRC_REPORT_CHART_SERIES_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "src/report/chart_frame.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

enum class MarkerStyle { kNone, kDot, kSquare, kTriangle, kStem };

/// One curve or cloud. Points that are not finite, not positive on a
/// logarithmic axis, or outside a given range are left out, and the line is
/// broken there. kStem stands on zero (or on the bottom of the chart) and draws
/// no line between points.
struct ChartSeries {
  std::string label;  ///< legend; empty = not listed
  std::vector<double> x;
  std::vector<double> y;
  bool line = true;
  MarkerStyle marker = MarkerStyle::kNone;
};

/// How the series with this index is drawn: colours that colour-blind readers
/// tell apart (Okabe, Ito 2008), repeated when they run out. The first series
/// has full markers, the others open ones, so that those below show through.
struct SeriesLook {
  std::string_view colour;
  std::string_view marker_fill;
  std::string_view dashes;
};
SeriesLook LookOf(std::size_t index);

/// Points of a series in pixels, without those that have no place on the axes;
/// a new run begins behind each of those.
using PixelRun = std::vector<SvgPoint>;
std::vector<PixelRun> PixelRuns(const ChartAxis& x, const ChartAxis& y,
                                const ChartSeries& series,
                                const PlotArea& plot);

/// Draws line and markers, thinned to what pixels can show: of a million points
/// the first, last, lowest and highest of each pixel column stay.
void DrawSeries(SvgWriter* svg, const ChartSeries& series,
                const SeriesLook& look, const PlotArea& plot,
                const std::vector<PixelRun>& runs);

/// The sample of a series in a legend, centred.
void DrawLegendKey(SvgWriter* svg, const ChartSeries& series,
                   const SeriesLook& look, SvgPoint centre);

/// Some points along what DrawSeries draws, to keep labels off it.
std::vector<SvgPoint> InkSamples(const ChartSeries& series,
                                 const PlotArea& plot,
                                 const std::vector<PixelRun>& runs);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CHART_SERIES_H_
