#include "src/report/chart_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

namespace {

// Beyond these the arithmetic of ticks overflows, or loses digits.
constexpr double kLargestDrawable = 1e300;
constexpr double kSmallestScale = 1e-290;
// Values that agree to this are equal for any reader.
constexpr double kEqual = 1e-9;
constexpr double kEqualColours = 1e-3;
constexpr double kPlaceMargin = 0.02;
constexpr double kIntegerMargin = 0.6;
constexpr double kColourMargin = 0.05;
// Tick labels are written out between these powers of ten.
constexpr int kSmallestPlainExponent = -2;
constexpr int kLargestPlainExponent = 4;
constexpr int kLargestIntegerExponent = 6;
// A logarithmic colour scale over less than this ratio has no power of ten to
// read values from and is drawn linear.
constexpr double kSmallestColourRatio = 10.0;

bool HasRange(const ChartAxis& axis) {
  return axis.lower < axis.upper && std::isfinite(axis.lower) &&
         std::isfinite(axis.upper) &&
         (!axis.logarithmic || axis.lower >= kSmallestScale);
}

double Largest(double a, double b) {
  return std::max(std::abs(a), std::abs(b));
}

double LinearStep(double span, int max_labels, bool integer) {
  const double step = StepAbove(span / max_labels);
  return integer ? std::max(step, 1.0) : step;
}

int DecadeStep(int decades, int max_labels) {
  for (const int step : {1, 2, 3, 5, 10, 20, 50}) {
    if (decades <= step * (max_labels - 1)) return step;
  }
  return 100;
}

std::string PowerLabel(int exponent) {
  if (exponent == 0) return "1";
  if (exponent == 1) return "10";
  return "10^" + std::to_string(exponent);
}

// "5" times ten to the exponent.
std::string MultipleLabel(int multiple, int exponent, bool plain) {
  if (plain) {
    return FixedNumber(multiple * std::pow(10.0, exponent),
                       std::max(0, -exponent));
  }
  if (multiple == 1) return PowerLabel(exponent);
  return std::to_string(multiple) + "×" + PowerLabel(exponent);
}

// With a minus sign in place of a hyphen.
std::string TickLabel(double value, int decimals) {
  std::string text = FixedNumber(value, decimals);
  if (text.front() == '-') text.replace(0, 1, "\u2212");
  return text;
}

// Puts "10^e" into the brackets of "error [mm]".
std::string ScaledLabel(const std::string& label, int exponent) {
  const std::string power = "10^" + std::to_string(exponent);
  const std::size_t bracket = label.rfind('[');
  if (bracket == std::string::npos) return label + " [" + power + "]";
  return label.substr(0, bracket + 1) + power + " " + label.substr(bracket + 1);
}

}  // namespace

double StepAbove(double smallest) {
  const double power = std::pow(10.0, std::floor(std::log10(smallest)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= smallest * (1.0 - kEqual)) return factor * power;
  }
  return 10.0 * power;
}

bool IsDrawable(const ChartAxis& axis, double value) {
  if (!std::isfinite(value) || std::abs(value) > kLargestDrawable) return false;
  if (axis.logarithmic && value < kSmallestScale) return false;
  return !HasRange(axis) || (value >= axis.lower && value <= axis.upper);
}

void ValueRange::Include(double value) {
  min = std::min(min, value);
  max = std::max(max, value);
}

AxisScale::AxisScale(const ChartAxis& axis, ValueRange data, Fit fit,
                     int max_labels)
    : logarithmic_(axis.logarithmic),
      max_labels_(max_labels),
      label_(axis.label) {
  if (HasRange(axis)) {
    lower_ = axis.lower;
    upper_ = axis.upper;
  } else if (logarithmic_) {
    if (data.empty()) data = {1.0, 10.0};
    FitLogarithmic(axis, data, fit);
  } else {
    if (data.empty()) data = {0.0, 1.0};
    FitLinear(axis, data, fit);
  }
  if (logarithmic_) {
    MakeDecadeTicks();
  } else {
    MakeLinearTicks(axis);
  }
}

double AxisScale::Fraction(double value) const {
  if (!logarithmic_) return (value - lower_) / (upper_ - lower_);
  const double low = std::log10(lower_);
  return (std::log10(value) - low) / (std::log10(upper_) - low);
}

void AxisScale::FitLinear(const ChartAxis& axis, ValueRange data, Fit fit) {
  lower_ = data.min;
  upper_ = data.max;
  const double size = Largest(lower_, upper_);
  if (size < kSmallestScale) {
    lower_ = 0.0;
    upper_ = 1.0;
    return;
  }
  const bool near_zero = lower_ >= 0.0 && lower_ < 0.6 * upper_;
  if (fit == Fit::kMagnitude && near_zero) lower_ = 0.0;
  const double equal = fit == Fit::kColour ? kEqualColours : kEqual;
  if (upper_ - lower_ <= equal * size) {
    const double margin = axis.integer_ticks ? std::max(1.0, kEqual * size)
                                             : kColourMargin * size;
    lower_ -= margin;
    upper_ += margin;
  }
  if (fit == Fit::kPlace) {
    double margin = kPlaceMargin * (upper_ - lower_);
    // Whole numbers that have no data get no tick.
    if (axis.integer_ticks) margin = std::min(margin, kIntegerMargin);
    lower_ -= margin;
    upper_ += margin;
  } else if (fit == Fit::kMagnitude) {
    const double step =
        LinearStep(upper_ - lower_, max_labels_, axis.integer_ticks);
    lower_ = step * std::floor(lower_ / step + kEqual);
    upper_ = step * std::ceil(upper_ / step - kEqual);
  }
}

void AxisScale::FitLogarithmic(const ChartAxis& axis, ValueRange data,
                               Fit fit) {
  if (fit == Fit::kColour) {
    logarithmic_ = data.max / data.min >= kSmallestColourRatio;
    if (!logarithmic_) return FitLinear(axis, data, fit);
    lower_ = data.min;
    upper_ = data.max;
    return;
  }
  const double lower = std::floor(std::log10(data.min) + kEqual);
  const double upper = std::ceil(std::log10(data.max) - kEqual);
  lower_ = std::pow(10.0, lower);
  upper_ = std::pow(10.0, std::max(upper, lower + 1.0));
}

void AxisScale::MakeLinearTicks(const ChartAxis& axis) {
  const int exponent = static_cast<int>(
      std::floor(std::log10(Largest(lower_, upper_)) + kEqual));
  const int largest =
      axis.integer_ticks ? kLargestIntegerExponent : kLargestPlainExponent;
  double unit = 1.0;
  if (exponent > largest || exponent < kSmallestPlainExponent) {
    unit = std::pow(10.0, exponent);
    label_ = ScaledLabel(label_, exponent);
  }
  const double lower = lower_ / unit;
  const double upper = upper_ / unit;
  const double step =
      LinearStep(upper - lower, max_labels_, axis.integer_ticks && unit == 1.0);
  const int decimals =
      std::max(0, -static_cast<int>(std::floor(std::log10(step) + kEqual)));
  const auto last =
      static_cast<std::int64_t>(std::floor(upper / step + kEqual));
  for (auto i = static_cast<std::int64_t>(std::ceil(lower / step - kEqual));
       i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    ticks_.push_back(
        {(value - lower) / (upper - lower), TickLabel(value, decimals)});
  }
}

void AxisScale::MakeDecadeTicks() {
  const double low = std::log10(lower_);
  const double high = std::log10(upper_);
  const int first = static_cast<int>(std::floor(low + kEqual));
  const int last = static_cast<int>(std::ceil(high - kEqual));
  const int step = DecadeStep(last - first, max_labels_);
  const bool plain =
      first >= kSmallestPlainExponent - 1 && last <= kLargestPlainExponent;
  // One decade alone has too few powers of ten to read values from.
  const bool label_multiples = last - first <= 1;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int k = 1; k <= (step == 1 ? 9 : 1); ++k) {
      const double place = (exponent + std::log10(k) - low) / (high - low);
      if (place < -kEqual || place > 1.0 + kEqual) continue;
      const bool labelled =
          k == 1 ? exponent % step == 0 : label_multiples && (k == 2 || k == 5);
      ticks_.push_back(
          {place, labelled ? MultipleLabel(k, exponent, plain) : ""});
    }
  }
}

}  // namespace alidade::internal
