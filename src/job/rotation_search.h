#ifndef ALIDADE_SRC_JOB_ROTATION_SEARCH_H_
#define ALIDADE_SRC_JOB_ROTATION_SEARCH_H_

#include <functional>
#include <optional>
#include <string>

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "src/dataio/rotation_convention.h"

namespace alidade::internal {

/// Orientations that are farther off those of the nominal arm (rad) are read
/// wrongly.
inline constexpr double kOrientationFits = 0.05;

/// A convention under which three angles fit the arm.
struct FittingRotation {
  std::string names;    ///< "extrinsic_xyz or intrinsic_zyx", which are one
  double misfit = 0.0;  ///< OrientationMisfit (rad)
};

/// The one convention under which the orientations that `load` reads fit the
/// nominal arm; nothing where there is none, or several do.
std::optional<FittingRotation> FindFittingRotation(
    const Arm& arm,
    const std::function<Dataset(const RotationConvention&)>& load);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ROTATION_SEARCH_H_
