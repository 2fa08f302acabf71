#ifndef ALIDADE_SRC_REPORT_QUANTITIES_H_
#define ALIDADE_SRC_REPORT_QUANTITIES_H_

#include <string>

#include "alidade/units.h"
#include "src/common/format.h"

namespace alidade::internal {

/// Lengths are shown in mm, angles in degrees.
inline double UnitOf(Dimension dimension) {
  return dimension == Dimension::kLength ? kMillimetre : kDegree;
}

/// As pages show it.
inline const char* UnitName(Dimension dimension) {
  return dimension == Dimension::kLength ? "mm" : "°";
}

inline std::string InUnit(double value, Dimension dimension, int digits) {
  return FormatSignificant(value / UnitOf(dimension), digits);
}

/// A difference: "+0.1", "-0.1", "0".
inline std::string WithSign(const std::string& text) {
  return text.front() == '-' || text == "0" ? text : "+" + text;
}

inline std::string Millimetres(double metres) {
  return FormatSignificant(metres / kMillimetre, 3);
}

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_QUANTITIES_H_
