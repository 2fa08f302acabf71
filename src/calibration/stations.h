#ifndef ALIDADE_SRC_CALIBRATION_STATIONS_H_
#define ALIDADE_SRC_CALIBRATION_STATIONS_H_

#include <optional>

#include "alidade/arm.h"
#include "src/calibration/position_sample.h"

namespace alidade::internal {

/// Where an instrument was moved in the course of a measurement.
struct StationChange {
  Eigen::Index column = 0;           ///< of the sample: the first after it
  Eigen::Index first_of_second = 0;  ///< its number among all positions
};

/// The one place in the order of a sample at which two bases, one before and
/// one after, fit the nominal arm best (least squares); nothing where either
/// part would have fewer than fifteen positions. Some 50 fits of frames.
std::optional<StationChange> FindStationChange(const Arm& arm,
                                               const PositionSample& sample);

/// Columns `from` to `to`, the latter excluded.
PositionSample TakePart(const PositionSample& sample, Eigen::Index from,
                        Eigen::Index to);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_STATIONS_H_
