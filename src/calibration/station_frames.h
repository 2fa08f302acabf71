#ifndef ALIDADE_SRC_CALIBRATION_STATION_FRAMES_H_
#define ALIDADE_SRC_CALIBRATION_STATION_FRAMES_H_

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// A station far from the first one.
struct MovedStation {
  std::string name;  ///< of its covariate
  /// From its instrument's frame to that of the first station.
  Eigen::Isometry3d first_from_station = Eigen::Isometry3d::Identity();
};

/// Brings the measurements of stations (CovariateUse::is_station) whose base is
/// elsewhere by more than some centimetres or degrees into the frame of the
/// first station: with each station's base b_k, found from its positions alone
/// and the nominal arm (initial_frames.h), a measurement p becomes
///
///   b_first b_k^-1 p
///
/// What is left of a station's motion is small, so that the fit may be linear
/// in it. Training and validation data change. Stations near the first stay;
/// and so do all where the base is not to be identified, no error terms are,
/// or other things than positions and poses were measured. O(N).
/// An arm that is to stay rigid (`errors: none`) gets what stations move its
/// base by as its only error terms.
std::vector<MovedStation> AlignStations(CalibrationTask* task);

/// Names of stations of which fewer than three training poses are here: their
/// base cannot be found, so that they are taken to stand where the first one
/// does.
std::vector<std::string> SmallStations(const CalibrationTask& task);

/// The effects of `arm` for the measurements as they were: what a station's
/// covariate moves the base by, times the motion that AlignStations undid. A
/// station that has no effect yet gets one.
void RestoreStations(const std::vector<MovedStation>& stations, Arm* arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_STATION_FRAMES_H_
