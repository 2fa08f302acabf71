#ifndef ALIDADE_SRC_COMMON_CONSTANTS_H_
#define ALIDADE_SRC_COMMON_CONSTANTS_H_

#include <array>
#include <limits>

namespace alidade::internal {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Of a metre or a radian.
inline constexpr double kMilli = 1e-3;

/// As doubles they are exact.
inline constexpr std::array<double, 13> kPowersOfTen = {
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_CONSTANTS_H_
