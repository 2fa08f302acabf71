#include "src/common/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr int kSmallestFixedExponent = -3;
constexpr int kLargestFixedExponent = 5;
// Fixed notation of a parameter beyond this is a row of meaningless digits.
constexpr double kLargestFixed = 1e9;

struct TimeUnit {
  double seconds;
  double below;  // used for durations below this
  const char* name;
};

constexpr TimeUnit kTimeUnits[] = {
    {1e-9, 1e-6, "ns"},     {1e-6, 1e-3, "us"},    {1e-3, 1.0, "ms"},
    {1.0, 120.0, "s"},      {60.0, 7200.0, "min"}, {3600.0, 172800.0, "h"},
    {86400.0, 0.0, "days"},
};

}  // namespace

std::string FormatSignificant(double value, int digits) {
  if (value == 0.0) return "0";
  if (!std::isfinite(value)) return FixedNumber(value, 0);
  const int kept = std::clamp(digits, 1, 17);
  // The exponent is read after rounding, so that 9.9996 to four digits is
  // 10.00 and not 10.000.
  std::string scientific = fmt::format("{:.{}e}", value, kept - 1);
  const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
  if (exponent < kSmallestFixedExponent || exponent > kLargestFixedExponent) {
    return scientific;
  }
  return FixedNumber(value, std::max(0, kept - 1 - exponent));
}

std::string FormatPercent(double share, int digits) {
  return FormatSignificant(100.0 * share, digits) + " %";
}

std::string FormatLength(double metres, int digits) {
  return FormatSignificant(metres / kMillimetre, digits) + " mm";
}

std::string FormatParameter(double value, Dimension dimension, int decimals) {
  const double unit = dimension == Dimension::kLength ? kMillimetre : kDegree;
  const double shown = value / unit;
  if (std::abs(shown) >= kLargestFixed) return FormatSignificant(shown, 10);
  return FixedNumber(shown, decimals);
}

const char* UnitForPeople(Dimension dimension) {
  return dimension == Dimension::kLength ? "mm" : "deg";
}

std::string FormatDuration(double seconds) {
  if (!std::isfinite(seconds)) return FixedNumber(seconds, 0) + " s";
  if (seconds == 0.0) return "0 s";
  const TimeUnit* unit = std::begin(kTimeUnits);
  const TimeUnit* last = std::end(kTimeUnits) - 1;
  while (unit != last && std::abs(seconds) >= unit->below) ++unit;
  return FormatSignificant(seconds / unit->seconds, 3) + " " + unit->name;
}

std::string FormatAccuracy(const Accuracy& accuracy) {
  if (accuracy.n == 0) return "nothing was evaluated";
  return fmt::format("mean {}, rms {}, p95 {}, max {} (n = {})",
                     FormatLength(accuracy.mean), FormatLength(accuracy.rms),
                     FormatLength(accuracy.p95), FormatLength(accuracy.max),
                     accuracy.n);
}

}  // namespace alidade::internal
