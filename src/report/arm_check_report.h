#ifndef ALIDADE_SRC_REPORT_ARM_CHECK_REPORT_H_
#define ALIDADE_SRC_REPORT_ARM_CHECK_REPORT_H_

#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/uncertainty/arm_check.h"

namespace alidade::internal {

/// Whether the arm is as calibrated, and what the check could have shown.
std::string FormatArmCheck(const Arm& arm, const ArmCheckResult& check);

/// What checks of as many poses would show; `planned`: the one chosen.
std::string FormatCheckPlan(const Arm& arm, const ArmCheckResult& planned,
                            const std::vector<ArmCheckResult>& by_number);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ARM_CHECK_REPORT_H_
