#ifndef ALIDADE_UNCERTAINTY_OPTIONS_H_
#define ALIDADE_UNCERTAINTY_OPTIONS_H_

#include <cstdint>

namespace alidade {

enum class IntervalMethod {
  /// Profile likelihood for parameters whose nonlinearity is above the limit,
  /// the linear model for all others.
  kAutomatic,
  kLinear,   ///< estimate +- quantile * standard deviation
  kProfile,  ///< profile likelihood for every parameter
};

/// How the uncertainty of a calibration is told.
struct UncertaintyOptions {
  double confidence = 0.95;  ///< of intervals and ellipsoids; in (0, 1)
  IntervalMethod intervals = IntervalMethod::kAutomatic;
  /// Above this (nonlinearity.h) linear intervals no longer hold what they
  /// say: a second-order part of a fifth of the standard deviation takes
  /// about 0.5 to 1 % from a coverage of 95 %.
  double nonlinearity_limit = 0.2;
  /// Configurations that the predicted map is drawn at, within the joint
  /// limits; 0 = no map.
  int map_configurations = 2000;
  std::uint64_t seed = 1;  ///< of these
};

}  // namespace alidade

#endif  // ALIDADE_UNCERTAINTY_OPTIONS_H_
