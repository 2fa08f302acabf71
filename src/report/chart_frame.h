#ifndef ALIDADE_SRC_REPORT_CHART_FRAME_H_
#define ALIDADE_SRC_REPORT_CHART_FRAME_H_

#include <string>
#include <string_view>
#include <vector>

#include "src/report/chart_scale.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

/// What all charts share: their size, the header, and the axes about the plot.

/// The sizes of text in figures.css.
inline constexpr double kTitleSize = 18.0;
inline constexpr double kSubtitleSize = 14.0;
inline constexpr double kLabelSize = 14.0;
inline constexpr double kTickSize = 13.0;

/// Half the width of a page, on a phone its whole width: narrower than a file,
/// so that letters stay readable.
inline constexpr double kPageWidth = 480.0;

struct ChartLayout {
  FigureMedium medium = FigureMedium::kFile;
  double width = 720.0;
  double margin = 24.0;
};
ChartLayout LayoutOf(FigureMedium medium, double page_width = kPageWidth);

/// Draws title and subtitle of a file; returns the y below them.
double DrawHeader(SvgWriter* svg, const ChartLayout& layout,
                  const std::string& title, const std::string& subtitle);

/// Widest label of a vertical axis.
double TickLabelWidth(const AxisScale& scale);

/// The y axis's part left of the plot: tick labels and turned axis label.
double LeftMargin(const ChartLayout& layout, const AxisScale& y);

/// The two scales over the plot's box.
struct PlotArea {
  SvgBox box;
  AxisScale x;
  AxisScale y;

  SvgPoint At(double x_value, double y_value) const;
};

/// A grid line, tick and label for each tick of a horizontal axis, and its
/// label.
void DrawAxisX(SvgWriter* svg, const SvgBox& box, const AxisScale& x);

/// Grid lines, ticks, labels and axis labels; the data go on top.
void DrawAxes(SvgWriter* svg, const PlotArea& plot);

/// An empty plot that says so.
void DrawNoData(SvgWriter* svg, const SvgBox& box);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CHART_FRAME_H_
