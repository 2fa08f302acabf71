#ifndef ALIDADE_SRC_COMMON_FORMAT_H_
#define ALIDADE_SRC_COMMON_FORMAT_H_

#include <string>

#include "alidade/accuracy.h"
#include "alidade/units.h"

namespace alidade::internal {

/// Numbers for people: mm and deg, digits that mean something.

/// `value` with `digits` significant digits, scientific below 1e-3 and from
/// 1e6: "0.01234", "2.31e-13", "0"; "nan", "inf", "-inf". Never "-0".
std::string FormatSignificant(double value, int digits);
/// A share of 1 in percent: FormatSignificant and " %".
std::string FormatPercent(double share, int digits);
/// A length in mm: FormatSignificant and " mm".
std::string FormatLength(double metres, int digits = 4);
/// A parameter in the unit people read (mm or deg) with fixed decimals and
/// without the unit; scientific from 1e9, where they mean nothing.
std::string FormatParameter(double value, Dimension dimension, int decimals);
/// "mm" or "deg".
const char* UnitForPeople(Dimension dimension);
/// Three significant digits: "12.3 ms", "1.25 s", "59.1 min".
std::string FormatDuration(double seconds);
/// "mean 3.215 mm, rms 3.402 mm, p95 5.010 mm, max 5.210 mm (n = 56)", or
/// "nothing was evaluated".
std::string FormatAccuracy(const Accuracy& accuracy);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_FORMAT_H_
