#include "src/calibration/data_split.h"

#include "alidade/error.h"
#include "src/error_terms/folds.h"

namespace alidade::internal {
namespace {

HoldOut Split(const Dataset& data, const HoldOutOptions& options,
              Communicator* communicator) {
  if (options.by == HoldOutBy::kPose) {
    return HoldOutFraction(data, options.fraction, options.seed, communicator);
  }
  if (data.partition) {
    throw InputError({},
                     "blocks and regions are drawn from all data, which are in "
                     "several processes here: hold out by pose");
  }
  const std::vector<bool> is_validation =
      options.by == HoldOutBy::kRegion
          ? RegionOf(data, options.fraction, options.seed)
          : BlocksOf(data, options.fraction, options.seed);
  return HoldOutPoses(data, is_validation);
}

}  // namespace

HoldOut SplitData(const Dataset& data, const HoldOutOptions& options,
                  Communicator* communicator) {
  HoldOut split = Split(data, options, communicator);
  if (split.train.global_poses() == 0 || split.validation.global_poses() == 0) {
    throw InputError(
        {},
        "holdout.fraction leaves no configuration on one side: the "
        "data set has too few different ones for it");
  }
  return split;
}

}  // namespace alidade::internal
