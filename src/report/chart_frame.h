#ifndef ALIDADE_SRC_REPORT_CHART_FRAME_H_
#define ALIDADE_SRC_REPORT_CHART_FRAME_H_

#include <string>
#include <string_view>
#include <vector>

#include "src/report/chart_scale.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {

/// What line charts and maps share: the look of text and grid, the header,
/// and the axes about the plot.

inline constexpr double kChartWidth = 720.0;
inline constexpr double kChartMargin = 24.0;

inline constexpr std::string_view kInkColour = "#1a1a1a";
inline constexpr std::string_view kTextColour = "#4d4d4d";
inline constexpr std::string_view kFrameColour = "#8c8c8c";
inline constexpr std::string_view kGridColour = "#dedede";
inline constexpr std::string_view kMinorGridColour = "#f2f2f2";

inline constexpr double kTitleSize = 18.0;
inline constexpr double kSubtitleSize = 14.0;
inline constexpr double kLabelSize = 14.0;
inline constexpr double kTickSize = 13.0;

/// Lines of `text` that fit the chart at a font size.
std::vector<std::string> FitText(std::string_view text, double size);

/// Draws title and subtitle; returns the y below them.
double DrawHeader(SvgWriter* svg, const std::string& title,
                  const std::string& subtitle);

/// Widest label of a vertical axis.
double TickLabelWidth(const AxisScale& scale);

/// The y axis's part left of the plot: tick labels and turned axis label.
double LeftMargin(const AxisScale& y);

/// The two scales over the plot's box.
struct PlotArea {
  SvgBox box;
  AxisScale x;
  AxisScale y;

  SvgPoint At(double x_value, double y_value) const;
};

/// Grid lines, ticks, labels and axis labels; the data go on top.
void DrawAxes(SvgWriter* svg, const PlotArea& plot);

/// An empty plot that says so.
void DrawNoData(SvgWriter* svg, const SvgBox& box);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CHART_FRAME_H_
