#include "src/report/chart_frame.h"

#include <algorithm>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr double kTickLength = 5.0;
constexpr double kMinorTickLength = 3.0;
constexpr double kTickGap = 4.0;
constexpr double kAxisLabelGap = 10.0;
constexpr double kLineSpacing = 1.3;
// A bold letter's width over a regular one's.
constexpr double kBold = 1.12;
// About the middle of digits above their base line, in font sizes.
constexpr double kHalfDigit = 0.36;

// Pixel grids put a line of one pixel sharply on half a pixel.
double Crisp(double pixel) { return static_cast<int>(pixel) + 0.5; }

double DrawLines(SvgWriter* svg, const std::string& text, double top,
                 const SvgText& style) {
  if (text.empty()) return top;
  for (const std::string& line :
       FitText(text, style.bold ? kBold * style.size : style.size)) {
    top += kLineSpacing * style.size;
    svg->Text({kChartMargin, top}, line, style);
  }
  return top;
}

void DrawGridX(SvgWriter* svg, const PlotArea& plot) {
  for (const AxisTick& tick : plot.x.ticks()) {
    const double x = Crisp(plot.box.left + tick.fraction * plot.box.width);
    const bool minor = tick.label.empty();
    svg->Line({x, plot.box.top}, {x, plot.box.bottom()},
              {minor ? kMinorGridColour : kGridColour});
  }
}

void DrawGridY(SvgWriter* svg, const PlotArea& plot) {
  for (const AxisTick& tick : plot.y.ticks()) {
    const double y = Crisp(plot.box.bottom() - tick.fraction * plot.box.height);
    const bool minor = tick.label.empty();
    svg->Line({plot.box.left, y}, {plot.box.right(), y},
              {minor ? kMinorGridColour : kGridColour});
  }
}

void DrawTicksX(SvgWriter* svg, const PlotArea& plot) {
  const double bottom = plot.box.bottom();
  for (const AxisTick& tick : plot.x.ticks()) {
    const double x = Crisp(plot.box.left + tick.fraction * plot.box.width);
    const double length = tick.label.empty() ? kMinorTickLength : kTickLength;
    svg->Line({x, bottom}, {x, bottom + length}, {kFrameColour});
    if (tick.label.empty()) continue;
    svg->Text({x, bottom + kTickLength + kTickGap + 0.8 * kTickSize},
              tick.label, {kTickSize, SvgText::Anchor::kMiddle, kTextColour});
  }
}

void DrawTicksY(SvgWriter* svg, const PlotArea& plot) {
  const double left = plot.box.left;
  for (const AxisTick& tick : plot.y.ticks()) {
    const double y = Crisp(plot.box.bottom() - tick.fraction * plot.box.height);
    const double length = tick.label.empty() ? kMinorTickLength : kTickLength;
    svg->Line({left - length, y}, {left, y}, {kFrameColour});
    if (tick.label.empty()) continue;
    svg->Text({left - kTickLength - kTickGap, y + kHalfDigit * kTickSize},
              tick.label, {kTickSize, SvgText::Anchor::kEnd, kTextColour});
  }
}

void DrawAxisLabels(SvgWriter* svg, const PlotArea& plot) {
  SvgText style{kLabelSize, SvgText::Anchor::kMiddle, kInkColour};
  svg->Text({plot.box.left + plot.box.width / 2.0,
             plot.box.bottom() + kTickLength + kTickGap + 2.6 * kTickSize},
            plot.x.label(), style);
  style.upwards = true;
  svg->Text(
      {plot.box.left - kTickLength - 2.5 * kTickGap - TickLabelWidth(plot.y),
       plot.box.top + plot.box.height / 2.0},
      plot.y.label(), style);
}

}  // namespace

std::vector<std::string> FitText(std::string_view text, double size) {
  const double room = kChartWidth - 2.0 * kChartMargin;
  std::vector<std::string> lines(1);
  for (const std::string& word : WrapText(text, 1)) {
    const std::string longer =
        lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || SvgTextWidth(longer, size) <= room) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

double DrawHeader(SvgWriter* svg, const std::string& title,
                  const std::string& subtitle) {
  SvgText title_style{kTitleSize, SvgText::Anchor::kStart, kInkColour};
  title_style.bold = true;
  const double below_title = DrawLines(svg, title, 8.0, title_style);
  const double below =
      DrawLines(svg, subtitle, below_title + 3.0,
                {kSubtitleSize, SvgText::Anchor::kStart, kTextColour});
  return below + 8.0;
}

double TickLabelWidth(const AxisScale& scale) {
  double width = 0.0;
  for (const AxisTick& tick : scale.ticks()) {
    width = std::max(width, SvgTextWidth(tick.label, kTickSize));
  }
  return width;
}

double LeftMargin(const AxisScale& y) {
  return kChartMargin + 0.6 * kLabelSize + kTickLength + kTickGap +
         kAxisLabelGap + TickLabelWidth(y);
}

SvgPoint PlotArea::At(double x_value, double y_value) const {
  return {box.left + x.Fraction(x_value) * box.width,
          box.bottom() - y.Fraction(y_value) * box.height};
}

void DrawAxes(SvgWriter* svg, const PlotArea& plot) {
  DrawGridX(svg, plot);
  DrawGridY(svg, plot);
  DrawTicksX(svg, plot);
  DrawTicksY(svg, plot);
  const double left = Crisp(plot.box.left);
  const double bottom = Crisp(plot.box.bottom());
  svg->Line({left, plot.box.top}, {left, bottom}, {kFrameColour});
  svg->Line({left, bottom}, {plot.box.right(), bottom}, {kFrameColour});
  DrawAxisLabels(svg, plot);
}

void DrawNoData(SvgWriter* svg, const SvgBox& box) {
  svg->Box(box, "#f5f5f5");
  svg->Text({box.left + box.width / 2.0, box.top + box.height / 2.0}, "no data",
            {kTitleSize, SvgText::Anchor::kMiddle, kTextColour});
}

}  // namespace alidade::internal
