#ifndef ALIDADE_UNITS_H_
#define ALIDADE_UNITS_H_

namespace alidade {

/// Everything inside Alidade is in SI units (m, rad, s). Files and people use
/// others; multiply by one of these to go in, divide to come out.
inline constexpr double kPi = 3.14159265358979323846264338327950288;
inline constexpr double kMetre = 1.0;
inline constexpr double kMillimetre = 1e-3;
inline constexpr double kMicrometre = 1e-6;
inline constexpr double kRadian = 1.0;
inline constexpr double kDegree = kPi / 180.0;
inline constexpr double kMilliradian = 1e-3;

/// What a quantity measures. A unit fits a quantity when dimensions agree.
enum class Dimension { kLength, kAngle };

}  // namespace alidade

#endif  // ALIDADE_UNITS_H_
