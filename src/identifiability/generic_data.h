#ifndef ALIDADE_SRC_IDENTIFIABILITY_GENERIC_DATA_H_
#define ALIDADE_SRC_IDENTIFIABILITY_GENERIC_DATA_H_

#include <cstdint>

#include "alidade/dataset.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// A data set that stands for all that could be measured in the way of `data`:
/// at poses drawn within the joint limits, every combination of kind, target,
/// reference and measured axes that `data` has anywhere. Contacts with points
/// and planes are taken as if they held at any pose: what such poses could
/// determine and those of `data` do not is then "not excited" (the size of an
/// arm, for one, that touches nothing whose place is known). Rows are in
/// metres: sigmas are 1 m, and the reach for orientations turned into lengths,
/// 1 / reach (rad). Measured orientations are those of the nominal arm.
Dataset MakeGenericData(const MeasurementModel& model, const Dataset& data,
                        int num_poses, std::uint64_t seed);

/// `data` with its rows in metres: sigmas of 1 m and 1 / reach (rad), no
/// correlations; what was not measured stays so.
Dataset WithUnitSigmas(const MeasurementModel& model, Dataset data);

/// About `count` observations of each kind, evenly spaced among those of the
/// same target, reference and axes and at least 32 of these where there are as
/// many, with the poses that they are of. `data` itself where it has no more
/// than `count` poses. Of a part: of the global data set, on every rank
/// (partition.h).
Dataset EvenSubset(Communicator* communicator, const Dataset& data,
                   Eigen::Index count);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_GENERIC_DATA_H_
