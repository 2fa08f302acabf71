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
    for (const std::size_t i : DrawablePoints(chart.x, chart.y, series)) {
      extent.x.Include(series.x[i]);
      extent.y.Include(series.y[i]);
      if (series.upper.empty()) continue;
      for (const double bound : {series.lower[i], series.upper[i]}) {
        if (IsDrawable(chart.y, bound)) extent.y.Include(bound);
      }
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
  const auto points = DrawablePoints(chart.x, chart.y, series);
  for (const std::size_t i : points) range.Include(series.y[i]);
  std::string text = series.label.empty() ? "One series" : series.label;
  text += ": " + Count(static_cast<std::int64_t>(points.size()), "point");
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
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const ChartSeries& series = chart.series[i];
    DrawBand(svg, series, LookOf(series, i), plot);
  }
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

namespace {

constexpr double kRowHeight = 22.0;
constexpr double kRowsBottomMargin = 52.0;
constexpr double kLabelGap = 8.0;
constexpr double kSquareCell = 60.0;
constexpr double kTurned = -60.0;
constexpr double kMatrixMargin = 150.0;
constexpr int kMaxLabels = 6;
// Of the width, that names of rows may take.
constexpr double kLabelShare = 0.42;
// Of a bold name's width over a regular one's.
constexpr double kBold = 1.1;

// What fits into `room`, its end as "…".
std::string Shortened(const std::string& label, double room) {
  if (SvgTextWidth(label, kBold * kTickSize) <= room) return label;
  std::string shorter = label;
  do {
    // Whole characters of UTF-8.
    do {
      shorter.pop_back();
    } while (!shorter.empty() && (shorter.back() & 0xC0) == 0x80);
  } while (!shorter.empty() &&
           SvgTextWidth(shorter + "…", kBold * kTickSize) > room);
  return shorter + "…";
}

template <typename Row>
double LabelRoom(const std::vector<Row>& rows, double width) {
  double longest = 0.0;
  for (const Row& row : rows) {
    longest = std::max(longest, SvgTextWidth(row.label, kBold * kTickSize));
  }
  return std::min(longest, kLabelShare * width);
}

template <typename Row>
void DrawRowLabel(SvgWriter* svg, const Row& row, double right, double room,
                  double middle) {
  svg->Text({right - kLabelGap, middle + 0.36 * kTickSize},
            Shortened(row.label, room),
            row.is_emphasised ? "strong end" : "tick end");
}

ValueRange RangeOf(const RowChart& chart) {
  ValueRange range = chart.range;
  if (range.empty()) {
    for (const ChartRow& row : chart.rows) {
      for (const RowMark& mark : row.marks) {
        for (const double value : {mark.at, mark.lower, mark.upper}) {
          if (IsDrawable(chart.x, value)) range.Include(value);
        }
      }
    }
  }
  if (!chart.x.logarithmic) range.Include(0.0);
  return range;
}

// A bar, and where it goes on an arrow.
void DrawBar(SvgWriter* svg, const RowMark& mark, const std::string& colour,
             const AxisScale& x, const SvgBox& box, double y) {
  if (!(mark.lower <= mark.upper) || std::isnan(x.Fraction(mark.lower))) return;
  const auto at = [&](double value) {
    return box.left + std::clamp(x.Fraction(value), 0.0, 1.0) * box.width;
  };
  const double left = at(mark.lower);
  const double right = at(mark.upper);
  std::string arrows;
  const std::string end = " " + SvgNumber(y);
  if (mark.lower < x.lower()) {
    arrows += "M" + SvgNumber(left) + end + "l6 -4v8z";
  }
  if (mark.upper > x.upper()) {
    arrows += "M" + SvgNumber(right) + end + "l-6 -4v8z";
  }
  svg->Path("M" + SvgNumber(left) + end + "H" + SvgNumber(right),
            "stem " + colour);
  if (!arrows.empty()) svg->Path(arrows, "mark full " + colour);
}

std::int64_t NumBars(const RowChart& chart) {
  return std::count_if(
      chart.looks.begin(), chart.looks.end(),
      [](const ChartSeries& look) { return look.marker == MarkerStyle::kBar; });
}

double RowHeight(const RowChart& chart) {
  constexpr double kBarHeight = 9.0;
  constexpr double kRowGap = 8.0;
  const auto bars = static_cast<double>(NumBars(chart));
  return std::max(kRowHeight, kBarHeight * bars + kRowGap);
}

// From zero, or the chart's end; those of a row stand one below the other.
void DrawRowBar(SvgWriter* svg, const RowChart& chart, const RowMark& mark,
                const AxisScale& x, const SvgBox& row) {
  if (!IsDrawable(chart.x, mark.at)) return;
  constexpr double kGap = 4.0;
  const double height =
      (row.height - kGap) / static_cast<double>(NumBars(chart));
  const double top =
      row.top + kGap / 2.0 + static_cast<double>(mark.series) * height;
  const double zero = chart.x.logarithmic ? 0.0 : x.Fraction(0.0);
  const double left = row.left + std::clamp(zero, 0.0, 1.0) * row.width;
  const double right =
      row.left + std::clamp(x.Fraction(mark.at), 0.0, 1.0) * row.width;
  const SeriesLook look = LookOf(chart.looks[mark.series], mark.series);
  svg->Path("M" + SvgNumber(left) + " " + SvgNumber(top) + "H" +
                SvgNumber(right) + "v" + SvgNumber(height - 1.0) + "H" +
                SvgNumber(left) + "z",
            BarLook(look));
  if (!mark.tip.empty()) svg->Tip({right, top + height / 2.0}, mark.tip);
}

void DrawMark(SvgWriter* svg, const RowChart& chart, const RowMark& mark,
              const AxisScale& x, const SvgBox& row) {
  const ChartSeries& series = chart.looks[mark.series];
  if (series.marker == MarkerStyle::kBar) {
    DrawRowBar(svg, chart, mark, x, row);
    return;
  }
  const double y = row.top + row.height / 2.0;
  const SeriesLook look = LookOf(series, mark.series);
  DrawBar(svg, mark, look.colour, x, row, y);
  if (!IsDrawable(chart.x, mark.at)) return;
  const SvgPoint at{row.left + x.Fraction(mark.at) * row.width, y};
  svg->Path(MarkerPath(series.marker, at, 4.5),
            (look.is_open ? "mark " : "mark full ") + look.colour);
  if (!mark.tip.empty()) svg->Tip(at, mark.tip);
}

void DrawRows(SvgWriter* svg, const RowChart& chart, const AxisScale& x,
              const SvgBox& box) {
  for (const double reference : chart.references) {
    const double place = x.Fraction(reference);
    if (!(place >= 0.0 && place <= 1.0)) continue;
    const double at = box.left + place * box.width;
    svg->Line({at, box.top}, {at, box.bottom()}, "reference");
  }
  SvgBox place{box.left, box.top, box.width, RowHeight(chart)};
  for (const ChartRow& row : chart.rows) {
    DrawRowLabel(svg, row, box.left, box.left - kLabelGap,
                 place.top + place.height / 2.0);
    for (const RowMark& mark : row.marks) {
      DrawMark(svg, chart, mark, x, place);
    }
    place.top += place.height;
  }
}

}  // namespace

std::string RenderSvg(const RowChart& chart, FigureMedium medium) {
  const ChartLayout layout = LayoutOf(medium);
  const double left =
      layout.margin + kLabelGap + LabelRoom(chart.rows, layout.width);
  const double rows = RowHeight(chart) * static_cast<double>(chart.rows.size());
  // The header is drawn twice: to know its height, and in its place.
  const auto draw_header = [&](SvgWriter* svg) {
    return DrawLegend(svg, layout, chart.looks,
                      DrawHeader(svg, layout, chart.title, chart.subtitle));
  };
  SvgWriter measured({}, "", "", FigureMedium::kPage);
  const double top = draw_header(&measured) + 4.0;
  SvgWriter svg({layout.width, top + rows + kRowsBottomMargin}, chart.title,
                chart.subtitle + " " + chart.x.label + " of " +
                    Count(static_cast<std::int64_t>(chart.rows.size()), "row"),
                medium);
  draw_header(&svg);
  const SvgBox box{left, top,
                   layout.width - std::max(layout.margin, 16.0) - left, rows};
  const AxisScale x(chart.x, RangeOf(chart), AxisScale::Fit::kMagnitude,
                    kMaxLabels);
  DrawAxisX(&svg, box, x);
  DrawRows(&svg, chart, x, box);
  return svg.Finish();
}

std::string RenderSvg(const MatrixChart& chart, FigureMedium medium) {
  const double cells =
      chart.cell_width * static_cast<double>(chart.columns.size());
  ChartLayout layout = LayoutOf(medium);
  const double room = LabelRoom(chart.rows, 720.0);
  const double left = layout.margin + room + kLabelGap;
  const bool has_notes =
      std::any_of(chart.rows.begin(), chart.rows.end(),
                  [](const MatrixRow& row) { return !row.note.empty(); });
  layout.width = std::max(medium == FigureMedium::kFile ? layout.width : 0.0,
                          left + cells + (has_notes ? kMatrixMargin : 40.0));
  const bool is_turned = chart.cell_width < kSquareCell;
  const double names = is_turned ? 60.0 : 28.0;
  const double header = medium == FigureMedium::kFile ? 80.0 : 0.0;
  const double top = header + names;
  const double height =
      top + chart.cell_height * static_cast<double>(chart.rows.size()) +
      layout.margin;
  SvgWriter svg({layout.width, height}, chart.title, chart.subtitle, medium);
  DrawHeader(&svg, layout, chart.title, chart.subtitle);
  for (std::size_t k = 0; k < chart.columns.size(); ++k) {
    const double x = left + chart.cell_width * (static_cast<double>(k) + 0.5);
    svg.Text({x + (is_turned ? 4.0 : 0.0), top - 8.0}, chart.columns[k],
             is_turned ? "tick" : "strong middle", is_turned ? kTurned : 0.0);
  }
  double y = top;
  for (const MatrixRow& row : chart.rows) {
    const double middle = y + chart.cell_height / 2.0;
    DrawRowLabel(&svg, row, left, room, middle);
    double x = left;
    for (const MatrixCell& cell : row.cells) {
      const SvgBox box{x, y, chart.cell_width - 1.0, chart.cell_height - 1.0};
      x += chart.cell_width;
      svg.Box(box, "empty");
      if (cell.colour.empty()) continue;
      svg.Box(box, "cell " + cell.colour, cell.opacity);
      const SvgPoint centre{box.left + box.width / 2.0, middle};
      if (!cell.text.empty()) {
        svg.Text({centre.x, middle + 0.36 * kTickSize}, cell.text,
                 is_turned ? "small strong middle" : "middle");
      }
      if (!cell.tip.empty()) svg.Tip(centre, cell.tip);
    }
    if (has_notes) {
      svg.Text({x + kLabelGap, middle + 0.36 * kTickSize}, row.note, "tick");
    }
    y += chart.cell_height;
  }
  return svg.Finish();
}

std::string RenderSvg(const PanelChart& chart, FigureMedium medium) {
  constexpr int kColumns = 2;
  constexpr double kTitleRoom = 30.0;
  ChartLayout layout = LayoutOf(medium);
  layout.width = kColumns * (kPageWidth + layout.margin) + layout.margin;
  const auto draw_header = [&](SvgWriter* svg) {
    return DrawHeader(svg, layout, chart.title, chart.subtitle);
  };
  SvgWriter measured({}, "", "", FigureMedium::kPage);
  const double top = draw_header(&measured);
  const std::size_t rows = (chart.panels.size() + kColumns - 1) / kColumns;
  const double height = kTitleRoom + kPageHeight;
  SvgWriter svg(
      {layout.width, top + height * static_cast<double>(rows) + layout.margin},
      chart.title, chart.subtitle, medium);
  draw_header(&svg);
  for (std::size_t k = 0; k < chart.panels.size(); ++k) {
    const std::size_t row = k / kColumns;
    const SvgPoint at{layout.margin + static_cast<double>(k % kColumns) *
                                          (kPageWidth + layout.margin),
                      top + static_cast<double>(row) * height + kTitleRoom};
    svg.Text({at.x, at.y - 8.0}, chart.panels[k].title, "label strong");
    svg.Inside(at, {kPageWidth, kPageHeight},
               RenderSvg(chart.panels[k], FigureMedium::kPage));
  }
  return svg.Finish();
}

}  // namespace alidade::internal
