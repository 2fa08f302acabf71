#include "src/calibration/calibration_task.h"

#include <utility>

#include "src/kernel/holdout.h"

namespace alidade::internal {

void HoldOutValidation(CalibrationTask* task) {
  if (!task->options.holdout || task->data.validation) return;
  const HoldOutOptions& options = *task->options.holdout;
  HoldOut split = HoldOutFraction(task->data.training, options.fraction,
                                  options.seed, task->communicator);
  task->data.training = std::move(split.train);
  task->data.validation = std::move(split.heldout);
}

}  // namespace alidade::internal
