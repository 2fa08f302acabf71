#ifndef ALIDADE_SRC_REPORT_CHART_FRAME_H_
#define ALIDADE_SRC_REPORT_CHART_FRAME_H_

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "src/report/svg_writer.h"

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

inline ChartAxis LogarithmicAxis(std::string label) {
  return {std::move(label), true};
}
/// Of whole numbers: poses, iterations.
inline ChartAxis CountAxis(std::string label) {
  ChartAxis axis{std::move(label)};
  axis.integer_ticks = true;
  return axis;
}

/// The smallest of 1, 2 or 5 times a power of ten that is not below `smallest`,
/// which is positive.
double StepAbove(double smallest);

/// True for a value that has a place on the axis: finite, positive where the
/// axis is logarithmic, inside the range where one is given.
bool IsDrawable(const ChartAxis& axis, double value);

struct ValueRange {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(min <= max); }
  void Include(double value);
};

struct AxisTick {
  double fraction = 0.0;  ///< place along the axis, 0 to 1
  std::string label;      ///< empty for a minor tick
};

/// Where values stand along an axis, and its ticks: steps of 1, 2 or 5 times a
/// power of ten, or decades. A linear axis of very small or large values counts
/// in a power of ten that is written into the label's unit: "error [10^-13
/// mm]".
class AxisScale {
 public:
  /// How a range that is not given is fitted to the data.
  enum class Fit {
    kMagnitude,  ///< from zero where the data come near it, to full steps
    kPlace,      ///< a small margin on either side
    kColour,     ///< exactly the data; values equal to 1e-3 get a wider range
  };

  /// @pre max_labels >= 2. An empty range is drawn as 0 to 1.
  AxisScale(const ChartAxis& axis, ValueRange data, Fit fit, int max_labels);

  double Fraction(double value) const;
  double lower() const { return lower_; }
  double upper() const { return upper_; }
  const std::vector<AxisTick>& ticks() const { return ticks_; }
  const std::string& label() const { return label_; }

 private:
  void FitLinear(const ChartAxis& axis, ValueRange data, Fit fit);
  void FitLogarithmic(const ChartAxis& axis, ValueRange data, Fit fit);
  void MakeLinearTicks(const ChartAxis& axis);
  void MakeDecadeTicks();

  bool logarithmic_;
  int max_labels_;
  double lower_ = 0.0;
  double upper_ = 1.0;
  std::string label_;
  std::vector<AxisTick> ticks_;
};

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
