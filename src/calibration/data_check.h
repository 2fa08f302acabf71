#ifndef ALIDADE_SRC_CALIBRATION_DATA_CHECK_H_
#define ALIDADE_SRC_CALIBRATION_DATA_CHECK_H_

#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/references.h"

namespace alidade::internal {

/// That a data set goes with the arm and the references: numbers of joints,
/// poses, observations and sigmas agree, and every observation names a pose, a
/// target and a reference that are there. O(1), but for lists of indices.
/// @throws InputError that names what disagrees.
void RequireConsistent(const Dataset& data, const Arm& arm,
                       const References& references);

/// That everything measured is a finite number. A fit finds out by itself; an
/// evaluation would pass it on. O(N). @throws InputError that names the pose.
void RequireFinite(const Dataset& data);

/// That there is a pose, that all sigmas are above 0, and RequireFinite: of
/// data that no reader has looked at. O(N). @throws InputError.
void RequireMeasurements(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_DATA_CHECK_H_
