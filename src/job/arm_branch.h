#ifndef ALIDADE_SRC_JOB_ARM_BRANCH_H_
#define ALIDADE_SRC_JOB_ARM_BRANCH_H_

#include <Eigen/Core>
#include <optional>
#include <string>

#include "alidade/arm.h"

namespace alidade::internal {

/// Which of its eight branches a six-joint arm is in, as cfx of RAPID states
/// it: 4 where the wrist centre is behind axis 1, plus 2 where it is behind the
/// lower arm (from axis 2 to axis 3), plus 1 where axis 5 is negative. In front
/// is where it is with all joints at zero. Nothing for arms whose last three
/// axes do not meet in a point, or whose first three are not of the usual kind
/// (axis 2 at right angles to axis 1, axis 3 parallel to axis 2).
std::optional<int> ArmBranch(const Arm& arm, const Eigen::VectorXd& joints);

/// "wrist centre in front of axis 1 and behind the lower arm, axis 5 negative".
std::string BranchMeaning(int branch);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ARM_BRANCH_H_
