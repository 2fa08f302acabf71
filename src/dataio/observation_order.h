#ifndef ALIDADE_SRC_DATAIO_OBSERVATION_ORDER_H_
#define ALIDADE_SRC_DATAIO_OBSERVATION_ORDER_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// One observation of a data set.
struct ObservationRef {
  const ObservationBlock* block = nullptr;
  Eigen::Index index = 0;

  int pose() const { return block->pose(index); }
};

/// All observations in the order of their poses, those of one pose in the order
/// of the blocks: the rows of a file. `data` must outlive them.
std::vector<ObservationRef> InOrderOfPoses(const Dataset& data);

/// Which sigmas say something: all those of positions, and of orientations,
/// that were measured are above zero (kUnstatedSigma is not).
struct StatedSigmas {
  bool positions = true;
  bool orientations = true;
};
StatedSigmas FindStatedSigmas(const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_OBSERVATION_ORDER_H_
