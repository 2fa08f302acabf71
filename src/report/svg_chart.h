#ifndef ALIDADE_SRC_REPORT_SVG_CHART_H_
#define ALIDADE_SRC_REPORT_SVG_CHART_H_

#include <string>
#include <vector>

#include "src/report/chart_scale.h"
#include "src/report/chart_series.h"

namespace alidade::internal {

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
