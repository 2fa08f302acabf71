#include "src/report/coverage_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "src/common/format.h"
#include "src/common/text.h"
#include "src/report/chart_frame.h"

namespace alidade::internal {
namespace {

constexpr int kBins = 24;
constexpr double kRowHeight = 46.0;
constexpr double kBarHeight = 30.0;
constexpr double kBase = 0.36 * kTickSize;  // of text beside a middle

std::vector<int> CountsOf(const CoverageRow& row) {
  std::vector<int> counts(kBins, 0);
  const double width = row.upper - row.lower;
  if (!(width > 0.0)) return counts;
  for (const double value : row.values) {
    const double place = (value - row.lower) / width;
    if (!std::isfinite(place)) continue;
    // Limits are kept to rounding.
    const int bin = static_cast<int>(std::floor(place * kBins));
    ++counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
  }
  return counts;
}

std::string Shown(double value, const std::string& unit) {
  return FormatSignificant(value, 3) + " " + unit;
}

void DrawRow(SvgWriter* svg, const CoverageRow& row, const SvgBox& box) {
  const std::vector<int> counts = CountsOf(row);
  const double most =
      std::max(1, *std::max_element(counts.begin(), counts.end()));
  const double side = box.width / kBins;
  svg->Box(box, "empty");
  std::string bars;
  for (int bin = 0; bin < kBins; ++bin) {
    const int count = counts[static_cast<std::size_t>(bin)];
    if (count == 0) continue;
    const double height = box.height * count / most;
    const double left = box.left + side * bin;
    bars += "M" + SvgNumber(left + 0.5) + " " + SvgNumber(box.bottom()) + "v" +
            SvgNumber(-height) + "h" + SvgNumber(side - 1.0) + "v" +
            SvgNumber(height) + "z";
    const double step = (row.upper - row.lower) / kBins;
    svg->Tip({left + side / 2.0, box.bottom() - height},
             row.label + ", " + Shown(row.lower + step * bin, row.unit) +
                 " to " + Shown(row.lower + step * (bin + 1), row.unit) +
                 ":\n" + Count(count, "pose"));
  }
  svg->Path(bars, "bar s1");
  svg->Line({box.left, box.bottom()}, {box.right(), box.bottom()}, "axis");
  // A stop where the joint has one.
  if (!row.has_limits) return;
  for (const double x : {box.left, box.right()}) {
    svg->Line({x, box.top - 2.0}, {x, box.bottom() + 3.0}, "axis");
  }
}

}  // namespace

std::string RenderSvg(const CoverageChart& chart, FigureMedium medium) {
  const ChartLayout layout = LayoutOf(medium);
  const auto draw_header = [&](SvgWriter* svg) {
    return DrawHeader(svg, layout, chart.title, chart.subtitle);
  };
  SvgWriter measured({}, "", "", FigureMedium::kPage);
  const double top = draw_header(&measured) + 4.0;
  const auto rows = static_cast<double>(chart.rows.size());
  SvgWriter svg(
      {layout.width, top + kRowHeight * rows + 8.0}, chart.title,
      chart.subtitle + " Histograms of " +
          Count(static_cast<std::int64_t>(chart.rows.size()), "joint"),
      medium);
  draw_header(&svg);
  double label = 0.0;
  double lower = 0.0;
  double upper = 0.0;
  for (const CoverageRow& row : chart.rows) {
    const auto widen = [](const std::string& text, double* width) {
      *width = std::max(*width, SvgTextWidth(text, kTickSize));
    };
    constexpr double kBold = 1.3;
    label = std::max(label, kBold * SvgTextWidth(row.label, kTickSize));
    widen(Shown(row.lower, row.unit), &lower);
    widen(Shown(row.upper, row.unit), &upper);
  }
  constexpr double kGap = 8.0;
  const double left = layout.margin + label + lower + 2.0 * kGap;
  const double right = layout.width - layout.margin - upper - kGap;
  double y = top;
  for (const CoverageRow& row : chart.rows) {
    const SvgBox box{left, y + 8.0, right - left, kBarHeight};
    const double middle = box.top + kBarHeight / 2.0 + kBase;
    svg.Text({layout.margin, middle}, row.label, "strong");
    svg.Text({left - kGap, middle}, Shown(row.lower, row.unit), "tick end");
    svg.Text({right + kGap, middle}, Shown(row.upper, row.unit), "tick");
    DrawRow(&svg, row, box);
    y += kRowHeight;
  }
  return svg.Finish();
}

}  // namespace alidade::internal
