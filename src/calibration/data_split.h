#ifndef ALIDADE_SRC_CALIBRATION_DATA_SPLIT_H_
#define ALIDADE_SRC_CALIBRATION_DATA_SPLIT_H_

#include "alidade/calibration_options.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {

/// Holds poses out as the options say. Random ones are drawn from all ranks of
/// a communicator; blocks and regions need the whole data set.
/// @throws InputError where one part would have no configuration, or the data
/// are a part.
HoldOut SplitData(const Dataset& data, const HoldOutOptions& options,
                  Communicator* communicator);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_DATA_SPLIT_H_
