#include "src/report/svg_chart.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/chart_frame.h"
#include "src/report/chart_scale.h"
#include "src/report/chart_series.h"
#include "src/report/svg_writer.h"

namespace alidade::internal {
namespace {

constexpr double kHeight = 420.0;
constexpr double kPageHeight = 300.0;
constexpr double kBottomMargin = 56.0;
constexpr int kMaxLabelsX = 10;
constexpr int kMaxLabelsOfPage = 6;
constexpr int kMaxLabelsY = 8;
constexpr double kReferenceSize = 13.0;
constexpr double kReferenceGap = 6.0;
constexpr double kDescentShare = 0.25;

struct DataExtent {
  ValueRange x;
  ValueRange y;
};

DataExtent ExtentOf(const LineChart& chart) {
  DataExtent extent;
  for (const ChartSeries& series : chart.series) {
    const std::size_t size = std::min(series.x.size(), series.y.size());
    for (std::size_t i = 0; i < size; ++i) {
      if (!IsDrawable(chart.x, series.x[i])) continue;
      if (!IsDrawable(chart.y, series.y[i])) continue;
      extent.x.Include(series.x[i]);
      extent.y.Include(series.y[i]);
    }
  }
  return extent;
}

bool HasStems(const LineChart& chart) {
  return std::any_of(chart.series.begin(), chart.series.end(),
                     [](const ChartSeries& series) {
                       return series.marker == MarkerStyle::kStem ||
                              series.marker == MarkerStyle::kBar;
                     });
}

// The values that the y axis must show: the data, the reference lines, and zero
// where stems stand on it.
ValueRange ShownRange(const LineChart& chart, ValueRange data) {
  for (const ChartReference& reference : chart.references) {
    if (IsDrawable(chart.y, reference.y)) data.Include(reference.y);
  }
  if (HasStems(chart) && !chart.y.logarithmic) data.Include(0.0);
  return data;
}

std::string Describe(const ChartSeries& series, const LineChart& chart) {
  ValueRange range;
  std::int64_t count = 0;
  const std::size_t size = std::min(series.x.size(), series.y.size());
  for (std::size_t i = 0; i < size; ++i) {
    if (!IsDrawable(chart.x, series.x[i])) continue;
    if (!IsDrawable(chart.y, series.y[i])) continue;
    range.Include(series.y[i]);
    ++count;
  }
  std::string text = series.label.empty() ? "One series" : series.label;
  text += ": " + Count(count, "point");
  if (range.empty()) return text + ".";
  return text + " from " + FormatSignificant(range.min, 4) + " to " +
         FormatSignificant(range.max, 4) + ".";
}

std::string Describe(const LineChart& chart) {
  std::string text = chart.subtitle;
  if (!text.empty()) text += ". ";
  text += "Chart of " + chart.y.label + " over " + chart.x.label + ".";
  for (const ChartSeries& series : chart.series) {
    text += " " + Describe(series, chart);
  }
  for (const ChartReference& reference : chart.references) {
    text += " Reference line at " + FormatSignificant(reference.y, 4) + ": " +
            reference.label + ".";
  }
  return text;
}

bool Covers(const SvgBox& box, SvgPoint point) {
  constexpr double kClearance = 5.0;
  return point.x > box.left - kClearance &&
         point.x < box.right() + kClearance && point.y > box.top - kClearance &&
         point.y < box.bottom() + kClearance;
}

struct LabelPlace {
  SvgBox box;
  bool at_right = true;
};

// The emptiest of the four places at the ends of the line, above or below it.
LabelPlace PlaceLabel(const SvgBox& plot, double line_y, double width,
                      const std::vector<SvgPoint>& ink) {
  const double above = line_y - kReferenceSize - kReferenceGap;
  const double below = line_y + kReferenceGap;
  LabelPlace best;
  std::int64_t fewest = -1;
  for (const bool at_right : {true, false}) {
    for (const double top : {above, below}) {
      const double left = at_right ? plot.right() - width - kReferenceGap
                                   : plot.left + kReferenceGap;
      const SvgBox box{left, top, width, kReferenceSize};
      const bool inside = top >= plot.top && box.bottom() <= plot.bottom();
      const std::int64_t covered =
          std::count_if(ink.begin(), ink.end(),
                        [&](SvgPoint point) { return Covers(box, point); }) +
          (inside ? 0 : static_cast<std::int64_t>(ink.size()) + 1);
      if (fewest >= 0 && covered >= fewest) continue;
      best = {box, at_right};
      fewest = covered;
    }
  }
  return best;
}

void DrawReferenceLines(SvgWriter* svg, const LineChart& chart,
                        const PlotArea& plot) {
  for (const ChartReference& reference : chart.references) {
    if (!IsDrawable(chart.y, reference.y)) continue;
    const double y = plot.At(plot.x.lower(), reference.y).y;
    svg->Line({plot.box.left, y}, {plot.box.right(), y}, "reference");
  }
}

void DrawReferenceLabels(SvgWriter* svg, const LineChart& chart,
                         const PlotArea& plot,
                         const std::vector<SvgPoint>& ink) {
  for (const ChartReference& reference : chart.references) {
    if (!IsDrawable(chart.y, reference.y)) continue;
    const double y = plot.At(plot.x.lower(), reference.y).y;
    const double width = SvgTextWidth(reference.label, kReferenceSize);
    const LabelPlace place = PlaceLabel(plot.box, y, width, ink);
    svg->Text({place.at_right ? place.box.right() : place.box.left,
               place.box.bottom() - kDescentShare * kReferenceSize},
              reference.label, place.at_right ? "halo end" : "halo");
  }
}

void DrawData(SvgWriter* svg, const LineChart& chart, const PlotArea& plot) {
  DrawReferenceLines(svg, chart, plot);
  std::vector<SvgPoint> ink;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    const std::vector<PixelRun> runs =
        PixelRuns(chart.x, chart.y, series, plot);
    DrawSeries(svg, series, LookOf(series, i), plot, runs);
    DrawTips(svg, chart.x, chart.y, series, plot);
    const std::vector<SvgPoint> samples = InkSamples(series, plot, runs);
    ink.insert(ink.end(), samples.begin(), samples.end());
  }
  DrawReferenceLabels(svg, chart, plot, ink);
}

}  // namespace

std::string RenderSvg(const LineChart& chart, FigureMedium medium) {
  const ChartLayout layout = LayoutOf(medium);
  const bool is_file = medium == FigureMedium::kFile;
  const double total = is_file ? kHeight : kPageHeight;
  SvgWriter svg({layout.width, total}, chart.title, Describe(chart), medium);
  const double below_header =
      DrawHeader(&svg, layout, chart.title, chart.subtitle);
  const double top = DrawLegend(&svg, layout, chart.series, below_header) + 8.0;
  const DataExtent extent = ExtentOf(chart);
  const double height = total - kBottomMargin - top;
  const double margin = layout.margin;
  if (extent.x.empty()) {
    DrawNoData(
        &svg, {margin, top, layout.width - 2.0 * margin, total - margin - top});
    return svg.Finish();
  }
  const AxisScale y(chart.y, ShownRange(chart, extent.y),
                    AxisScale::Fit::kMagnitude, kMaxLabelsY);
  const AxisScale x(chart.x, extent.x, AxisScale::Fit::kPlace,
                    is_file ? kMaxLabelsX : kMaxLabelsOfPage);
  const double left = LeftMargin(layout, y);
  const PlotArea plot{
      {left, top, layout.width - std::max(margin, 16.0) - left, height}, x, y};
  DrawAxes(&svg, plot);
  DrawData(&svg, chart, plot);
  return svg.Finish();
}

}  // namespace alidade::internal
