#ifndef ALIDADE_SRC_JOB_ARM_SHAPES_H_
#define ALIDADE_SRC_JOB_ARM_SHAPES_H_

#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "src/report/arm_view.h"

namespace alidade::internal {

/// What the links of an arm look like, where one of the files that a result
/// was made of is an arm file with a URDF whose meshes are there, and both are
/// still what they were. Never fails: what is missing or cannot be read is said
/// in its notes. Some thousand triangles in all.
ArmShapes ShapesOf(const std::vector<InputFile>& inputs, const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_ARM_SHAPES_H_
