#ifndef ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_
#define ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_

#include <string>
#include <vector>

#include "src/serialization/yaml_tree.h"

namespace alidade::internal {

/// Reads a job file and those that it inherits from: `extends: BASE.yaml` lays
/// the file on BASE, map by map, lists and single values replaced (Overlay of
/// yaml_merge.h). Every value keeps its file, line and column, and paths stay
/// relative to the file that states them. The key `extends` is gone from the
/// result; `matrix` is left to who reads it.
///
/// A file that states other `units` than its base is refused: they would change
/// what the base's numbers mean.
/// @throws InputError, also where files extend each other in a circle.
YamlDocument ReadJobTree(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_JOB_TREE_H_
