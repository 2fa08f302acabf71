#ifndef ALIDADE_SRC_REPORT_SVG_CHART_H_
#define ALIDADE_SRC_REPORT_SVG_CHART_H_

#include <string>
#include <vector>

namespace alidade::internal {

/// One axis. The range is fitted to the data where lower >= upper, or where it
/// cannot be drawn (not finite, not positive on a logarithmic axis). A linear
/// axis of very small or large values counts in a power of ten, written into
/// the brackets of the label: "error [10^-13 mm]".
struct ChartAxis {
  std::string label;  ///< with its unit: "error [mm]"
  bool logarithmic = false;
  double lower = 0.0;
  double upper = 0.0;
  bool integer_ticks = false;
};

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

/// A horizontal reference line with its label. A fitted range includes it.
struct ChartReference {
  double y = 0.0;
  std::string label;
};

struct LineChart {
  std::string title;
  std::string subtitle;  ///< the headline number in words
  ChartAxis x;
  ChartAxis y;
  std::vector<ChartSeries> series;
  std::vector<ChartReference> references;
};

/// A value at points of a plane, as coloured squares with a colour bar.
struct MapChart {
  std::string title;
  std::string subtitle;
  ChartAxis x;
  ChartAxis y;
  ChartAxis colour;
  /// A unit of x is as long as a unit of y: shapes keep their proportions.
  bool equal_scale = true;
  std::vector<double> px;
  std::vector<double> py;
  std::vector<double> value;
};

/// One self-contained SVG document (no scripts, no fonts to load), colours that
/// colour-blind readers tell apart, text escaped, the title and a description
/// for screen readers. Powers of ten in any text, written 10^-13, are set with
/// a superscript. Without a drawable point the chart says "no data". Any number
/// of points: what pixels cannot show is thinned. Deterministic: same input,
/// same bytes.
std::string RenderSvg(const LineChart& chart);
std::string RenderSvg(const MapChart& chart);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_SVG_CHART_H_
