#ifndef ALIDADE_SRC_COMMON_NUMBER_TEXT_H_
#define ALIDADE_SRC_COMMON_NUMBER_TEXT_H_

#include <string>
#include <string_view>

namespace alidade::internal {

/// Numbers as text, independent of the locale. What appends to a text is for
/// tables of many rows: 10 to 40 ns a number.

/// `decimals` fixed decimals: "-1.50", "0.00" also for values that round to
/// minus zero, "nan", "inf", "-inf".
std::string FixedNumber(double value, int decimals);
/// A share of 1 in percent: FixedNumber and " %".
std::string FixedPercent(double share, int decimals);
void AppendFixed(double value, int decimals, std::string* text);

/// In place of a number of decimals: the fewest digits that read back to the
/// same double.
inline constexpr int kFewestDigits = -1;

/// The shortest text that reads back to the same double: "0.1", "2.1e-13".
std::string ShortestNumber(double value);
void AppendShortest(double value, std::string* text);

/// What ShortestNumber wrote; NaN for anything that is no number.
double NumberOrNan(std::string_view text);

/// value * 10^exponent in decimal: the fewest digits that read back to `value`
/// with the point moved, so that ParseNumber(text, -exponent) gives the same
/// bits, the sign of a zero included.
std::string FormatShifted(double value, int exponent);
void AppendShifted(double value, int exponent, std::string* text);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_NUMBER_TEXT_H_
