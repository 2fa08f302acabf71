#ifndef ALIDADE_SRC_REPORT_CHART_SCALE_H_
#define ALIDADE_SRC_REPORT_CHART_SCALE_H_

#include <limits>
#include <string>
#include <vector>

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

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_CHART_SCALE_H_
