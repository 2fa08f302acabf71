#ifndef ALIDADE_SRC_PLANNING_PLAN_TASK_H_
#define ALIDADE_SRC_PLANNING_PLAN_TASK_H_

#include "alidade/plan.h"
#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// The arguments of PlanPoses.
struct PlanTask : PlanOptions {
  /// Arm, references, what was measured already (`data`, which may have no
  /// poses) and what is to be identified.
  CalibrationTask job;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_TASK_H_
