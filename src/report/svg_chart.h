#ifndef ALIDADE_SRC_REPORT_SVG_CHART_H_
#define ALIDADE_SRC_REPORT_SVG_CHART_H_

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "src/report/chart_frame.h"
#include "src/report/chart_series.h"

namespace alidade::internal {

/// A horizontal reference line with its label. A fitted range includes it.
struct ChartReference {
  double y = 0.0;
  std::string label = {};
};

struct LineChart {
  std::string title = {};
  std::string subtitle = {};  ///< the headline number in words
  ChartAxis x = {};
  ChartAxis y = {};
  std::vector<ChartSeries> series = {};
  std::vector<ChartReference> references = {};
};

/// Small multiples: charts beside and below each other, for a file.
struct PanelChart {
  std::string title = {};
  std::string subtitle = {};
  std::vector<LineChart> panels = {};
};

/// A value at points of a plane, as coloured squares with a colour bar.
struct MapChart {
  std::string title = {};
  std::string subtitle = {};
  ChartAxis x = {};
  ChartAxis y = {};
  ChartAxis colour = {};
  /// A unit of x is as long as a unit of y: shapes keep their proportions.
  bool equal_scale = true;
  /// The points are the middles of squares of this size, in units of x; 0:
  /// samples at any places, between which squares are filled in.
  double cell_size = 0.0;
  std::vector<double> px = {};
  std::vector<double> py = {};
  std::vector<double> value = {};
  /// What is said of a point under the pointer.
  std::function<std::string(std::size_t)> tip = {};
  /// An arm that the map is around, from its base on; may be empty.
  std::vector<std::pair<double, double>> outline = {};
  /// A place that has a ring and a name; nothing without a name.
  std::pair<double, double> marked = {};
  std::string marked_name = {};
};

/// A marker of a row, and a bar from `lower` to `upper` where there is one,
/// with an arrow where it goes on beyond the chart.
struct RowMark {
  double at = 0.0;
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
  std::size_t series = 0;  ///< whose look it has
  std::string tip = {};
};

struct ChartRow {
  std::string label = {};
  std::vector<RowMark> marks = {};
  bool is_emphasised = false;
};

/// Rows of marks over one axis: a row a parameter or an arm. A given range is
/// widened to whole ticks; zero is in a linear one. Looks that are bars come
/// first; the bars of a row stand one below the other.
struct RowChart {
  std::string title = {};
  std::string subtitle = {};
  ChartAxis x = {};
  ValueRange range = {};  ///< what the axis shows; empty: all marks and bars
  std::vector<ChartSeries> looks = {};  ///< label, colour and marker
  std::vector<ChartRow> rows = {};
  std::vector<double> references = {};  ///< vertical lines
};

struct MatrixCell {
  std::string text = {};
  std::string colour = {};  ///< "s1" to "s7"; empty = the cell is not drawn
  double opacity = 1.0;     ///< of the colour
  std::string tip = {};
};

struct MatrixRow {
  std::string label = {};
  std::vector<MatrixCell> cells = {};  ///< one for each column
  std::string note = {};               ///< stands after the last cell
  bool is_emphasised = false;
};

/// A table of coloured cells.
struct MatrixChart {
  std::string title = {};
  std::string subtitle = {};
  std::vector<std::string> columns = {};
  std::vector<MatrixRow> rows = {};
  double cell_width = 88.0;  ///< below 60, names of columns are turned
  double cell_height = 30.0;
};

/// The colour of maps (Viridis) at a fraction from 0 to 1.
std::string MapColour(double fraction);

/// One figure, colours that colour-blind readers distinguish, text escaped, a
/// title and a description for screen readers; no scripts and no fonts to load.
/// A file (the default) is a self-contained SVG document. Numbers in any text
/// are typeset. Without a drawable point the chart says "no data". Any number
/// of points: what pixels cannot show is thinned. Deterministic: same input,
/// same bytes.
std::string RenderSvg(const LineChart& chart,
                      FigureMedium medium = FigureMedium::kFile);
std::string RenderSvg(const MapChart& chart,
                      FigureMedium medium = FigureMedium::kFile);
std::string RenderSvg(const RowChart& chart,
                      FigureMedium medium = FigureMedium::kFile);
std::string RenderSvg(const MatrixChart& chart,
                      FigureMedium medium = FigureMedium::kFile);
std::string RenderSvg(const PanelChart& chart,
                      FigureMedium medium = FigureMedium::kFile);

/// Any of these charts.
struct Figure {
  Figure() = default;
  template <typename Chart>
  Figure(Chart chart)  // NOLINT: a chart is a figure
      : title(chart.title),
        subtitle(chart.subtitle),
        render([chart = std::move(chart)](FigureMedium medium) {
          return RenderSvg(chart, medium);
        }) {}

  std::string title;
  std::string subtitle;
  std::function<std::string(FigureMedium)> render;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_SVG_CHART_H_
