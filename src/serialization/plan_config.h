#ifndef ALIDADE_SRC_SERIALIZATION_PLAN_CONFIG_H_
#define ALIDADE_SRC_SERIALIZATION_PLAN_CONFIG_H_

#include <string>
#include <vector>

#include "src/planning/plan_task.h"

namespace alidade::internal {

/// A plan file, its files loaded and checked.
struct PlanConfig : PlanTask {
  std::string path;
  std::string title;
  std::vector<std::string> input_files;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_PLAN_CONFIG_H_
