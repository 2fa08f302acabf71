#ifndef ALIDADE_SRC_COMMON_NUMBERS_H_
#define ALIDADE_SRC_COMMON_NUMBERS_H_

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "alidade/units.h"

namespace alidade::internal {

/// A unit that files may state. SI value = number * 10^exponent * factor; the
/// power of ten is applied to the decimal text, so that a length in mm is read
/// to the double nearest to it in m and is written back with the same digits.
struct Unit {
  const char* name;
  Dimension dimension;
  int exponent;
  double factor;

  double InSi() const { return std::pow(10.0, exponent) * factor; }
};

/// The unit of a name, or null.
const Unit* FindUnit(std::string_view name);

/// Names of the units that fit a dimension: "mm, m, um" or "deg, rad, mrad".
std::vector<std::string> UnitNames(Dimension dimension);

/// "length" or "angle".
const char* DimensionName(Dimension dimension);

/// The integer that all of `text` is, without a plus sign, where it fits its
/// type.
template <typename Integer>
std::optional<Integer> ParseWhole(std::string_view text) {
  Integer value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

/// `text` times 10^exponent, rounded once. Nothing unless all of `text` is one
/// finite decimal number: an optional '-', digits with at most one decimal
/// point, an optional exponent. Does not depend on the locale.
std::optional<double> ParseNumber(std::string_view text, int exponent = 0);

/// value * 10^exponent, rounded once, of the decimal of at most 15 digits, six
/// of them after the point, that `value` is the nearest double to; NaN where it
/// is none. @pre -6 <= exponent <= 0.
double ShiftShort(double value, int exponent);

/// The SI value of `text` in `unit`; nothing where ParseNumber gives nothing.
std::optional<double> ParseQuantity(std::string_view text, const Unit& unit);
/// The same, but NaN for nothing: an optional on its way through memory takes
/// as long as half of the reading.
double QuantityOrNan(std::string_view text, const Unit& unit);

/// Why ParseNumber refused `text`, and what to write instead. `unit_hint` says
/// where a unit belongs: "state the unit in \"units\"".
std::string DescribeBadNumber(std::string_view text,
                              std::string_view unit_hint);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_NUMBERS_H_
