#include "src/report/svg_chart.h"

#include <algorithm>
#include <cmath>
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

void DrawReferenceLines(SvgWriter* svg, const LineChart& chart,
                        const PlotArea& plot) {
  for (const ChartReference& reference : chart.references) {
    if (!IsDrawable(chart.y, reference.y)) continue;
    const double y = plot.At(plot.x.lower(), reference.y).y;
    svg->Line({plot.box.left, y}, {plot.box.right(), y}, "reference");
  }
}

// Above the line, at the end that fewer points are near.
void DrawReferenceLabels(SvgWriter* svg, const LineChart& chart,
                         const PlotArea& plot,
                         const std::vector<PixelRun>& points) {
  for (const ChartReference& reference : chart.references) {
    if (!IsDrawable(chart.y, reference.y)) continue;
    const double y = plot.At(plot.x.lower(), reference.y).y;
    const double width = SvgTextWidth(reference.label, kReferenceSize);
    std::int64_t at_right = 0;
    for (const PixelRun& run : points) {
      for (const SvgPoint point : run) {
        if (std::abs(point.y - y) > 2.0 * kReferenceSize) continue;
        at_right += point.x > plot.box.right() - width ? 1 : 0;
        at_right -= point.x < plot.box.left + width ? 1 : 0;
      }
    }
    const bool is_right = at_right <= 0;
    svg->Text({is_right ? plot.box.right() - kReferenceGap
                        : plot.box.left + kReferenceGap,
               y - kReferenceGap},
              reference.label, is_right ? "halo end" : "halo");
  }
}

void DrawData(SvgWriter* svg, const LineChart& chart, const PlotArea& plot) {
  DrawReferenceLines(svg, chart, plot);
  std::vector<PixelRun> points;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    const std::vector<PixelRun> runs =
        PixelRuns(chart.x, chart.y, series, plot);
    DrawSeries(svg, series, LookOf(series, i), plot, runs);
    DrawTips(svg, chart.x, chart.y, series, plot);
    points.insert(points.end(), runs.begin(), runs.end());
  }
  DrawReferenceLabels(svg, chart, plot, points);
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
