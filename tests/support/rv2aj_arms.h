#ifndef ALIDADE_TESTS_SUPPORT_RV2AJ_ARMS_H_
#define ALIDADE_TESTS_SUPPORT_RV2AJ_ARMS_H_

#include "alidade/arm.h"
#include "alidade/units.h"

namespace alidade::internal::testing {

/// The Mitsubishi RV-2AJ of the reference case, measured at its wrist centre
/// (r5 = 0, no tool).
Arm Rv2ajWrist();

/// The same arm measured at its flange (r5 = 72 mm).
Arm Rv2ajFlange();

/// `nominal` (either of the above) with the deviations of the assumed real
/// arm.
Arm WithRv2ajDeviations(const Arm& nominal);

}  // namespace alidade::internal::testing

#endif  // ALIDADE_TESTS_SUPPORT_RV2AJ_ARMS_H_
