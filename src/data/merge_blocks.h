#ifndef ALIDADE_SRC_DATA_MERGE_BLOCKS_H_
#define ALIDADE_SRC_DATA_MERGE_BLOCKS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// A block of one of the parts that a data set is put together from.
struct PartBlock {
  const ObservationBlock* block = nullptr;
  int first_pose = 0;      ///< of the part, among all poses
  std::size_t number = 0;  ///< of the part
};

/// Observations of one kind, one part after the other. Lists and whiteners that
/// one part has and another leaves out are filled in. @pre parts is not empty,
/// all are of the same kind.
ObservationBlock MergeBlocks(const std::vector<PartBlock>& parts,
                             Eigen::Index num_poses);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATA_MERGE_BLOCKS_H_
