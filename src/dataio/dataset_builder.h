#ifndef ALIDADE_SRC_DATAIO_DATASET_BUILDER_H_
#define ALIDADE_SRC_DATAIO_DATASET_BUILDER_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// One observation, before it is a column of a block.
struct Observation {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

  MeasurementKind kind = MeasurementKind::kPosition;
  int pose = 0;
  int target = 0;
  int reference = 0;
  int second = 0;
  Rows measured = {};
  Rows sigmas = {};
  Eigen::MatrixXd whitener = {};  ///< empty: the sigmas say it all
};

/// One block per kind, in the order that the kinds first come in. Lists that
/// say nothing (poses 0, 1, ... of a data set with as many; the first target
/// everywhere) are left empty, as dataset.h has it.
std::vector<ObservationBlock> MakeBlocks(
    const std::vector<Observation>& observations, Eigen::Index num_poses);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATAIO_DATASET_BUILDER_H_
