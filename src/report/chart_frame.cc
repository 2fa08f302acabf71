#include "src/report/chart_frame.h"

#include <algorithm>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr double kPageMargin = 6.0;
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

// Lines of `text` that are at most `room` wide at a font size.
std::vector<std::string> FitText(std::string_view text, double size,
                                 double room) {
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

double DrawLines(SvgWriter* svg, const ChartLayout& layout,
                 const std::string& text, double top, double size,
                 std::string_view look) {
  if (text.empty()) return top;
  const double bold = look == "title" ? kBold : 1.0;
  for (const std::string& line :
       FitText(text, bold * size, layout.width - 2.0 * layout.margin)) {
    top += kLineSpacing * size;
    svg->Text({layout.margin, top}, line, look);
  }
  return top;
}

void DrawAxisY(SvgWriter* svg, const SvgBox& box, const AxisScale& y) {
  for (const AxisTick& tick : y.ticks()) {
    const double at = Crisp(box.bottom() - tick.fraction * box.height);
    const bool minor = tick.label.empty();
    svg->Line({box.left, at}, {box.right(), at}, minor ? "minor" : "grid");
    svg->Line({box.left - (minor ? kMinorTickLength : kTickLength), at},
              {box.left, at}, "axis");
    if (minor) continue;
    svg->Text({box.left - kTickLength - kTickGap, at + kHalfDigit * kTickSize},
              tick.label, "tick end");
  }
  svg->Line({Crisp(box.left), box.top}, {Crisp(box.left), Crisp(box.bottom())},
            "axis");
  svg->Text({box.left - kTickLength - 2.5 * kTickGap - TickLabelWidth(y),
             box.top + box.height / 2.0},
            y.label(), "label middle", -90.0);
}

}  // namespace

ChartLayout LayoutOf(FigureMedium medium, double page_width) {
  return medium == FigureMedium::kFile
             ? ChartLayout{}
             : ChartLayout{medium, page_width, kPageMargin};
}

double DrawHeader(SvgWriter* svg, const ChartLayout& layout,
                  const std::string& title, const std::string& subtitle) {
  if (layout.medium == FigureMedium::kPage) return 4.0;
  const double below = DrawLines(svg, layout, title, 8.0, kTitleSize, "title");
  return DrawLines(svg, layout, subtitle, below + 3.0, kSubtitleSize,
                   "subtitle") +
         8.0;
}

double TickLabelWidth(const AxisScale& scale) {
  double width = 0.0;
  for (const AxisTick& tick : scale.ticks()) {
    width = std::max(width, SvgTextWidth(tick.label, kTickSize));
  }
  return width;
}

double LeftMargin(const ChartLayout& layout, const AxisScale& y) {
  return layout.margin + 0.6 * kLabelSize + kTickLength + kTickGap +
         kAxisLabelGap + TickLabelWidth(y);
}

SvgPoint PlotArea::At(double x_value, double y_value) const {
  return {box.left + x.Fraction(x_value) * box.width,
          box.bottom() - y.Fraction(y_value) * box.height};
}

void DrawAxisX(SvgWriter* svg, const SvgBox& box, const AxisScale& x) {
  for (const AxisTick& tick : x.ticks()) {
    const double at = Crisp(box.left + tick.fraction * box.width);
    const bool minor = tick.label.empty();
    svg->Line({at, box.top}, {at, box.bottom()}, minor ? "minor" : "grid");
    svg->Line({at, box.bottom()},
              {at, box.bottom() + (minor ? kMinorTickLength : kTickLength)},
              "axis");
    if (minor) continue;
    svg->Text({at, box.bottom() + kTickLength + kTickGap + 0.8 * kTickSize},
              tick.label, "tick middle");
  }
  const double bottom = Crisp(box.bottom());
  svg->Line({Crisp(box.left), bottom}, {box.right(), bottom}, "axis");
  svg->Text({box.left + box.width / 2.0,
             box.bottom() + kTickLength + kTickGap + 2.6 * kTickSize},
            x.label(), "label middle");
}

void DrawAxes(SvgWriter* svg, const PlotArea& plot) {
  DrawAxisX(svg, plot.box, plot.x);
  DrawAxisY(svg, plot.box, plot.y);
}

void DrawNoData(SvgWriter* svg, const SvgBox& box) {
  svg->Box(box, "empty");
  svg->Text({box.left + box.width / 2.0, box.top + box.height / 2.0}, "no data",
            "label middle");
}

}  // namespace alidade::internal
