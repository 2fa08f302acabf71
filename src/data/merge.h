#ifndef ALIDADE_SRC_DATA_MERGE_H_
#define ALIDADE_SRC_DATA_MERGE_H_

#include <vector>

#include "alidade/dataset.h"

namespace alidade::internal {

/// All poses and observations of `parts`, in their order, as one data set: a
/// block for each kind, kinds in the order that they first come in, and a shard
/// for each part. Numbers of poses and of files are counted on; sources are
/// kept where all parts have them. Matrices are copied part by part, at the
/// speed of memory. One part stays as it is.
/// @pre there is one; as many joints in each; references have the same numbers
/// in each.
Dataset MergeDatasets(std::vector<Dataset> parts);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_DATA_MERGE_H_
