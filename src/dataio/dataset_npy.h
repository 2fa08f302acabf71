#ifndef ALIDADE_SRC_DATAIO_DATASET_NPY_H_
#define ALIDADE_SRC_DATAIO_DATASET_NPY_H_

#include <string>

#include "alidade/arm.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// True for names that end in ".npy", whatever their case.
bool IsNpy(const std::string& path);

/// The bytes of a NumPy array of a data set of positions or poses, which
/// LoadData reads from a file of that name: one row for each observation, in
/// the order of poses, in SI. Joint values (where the arm has no motor map),
/// positions and sigmas read back to the same bits; orientations, as rotation
/// vectors, to rounding. Sigmas are written when `with_sigmas` (not
/// kUnstatedSigma). What was not measured is NaN.
/// @pre blocks are of kPosition and kPose, of the first target, without
/// whiteners.
std::string FormatNpy(const Dataset& dataset, const Arm& arm, bool with_sigmas);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_NPY_H_
