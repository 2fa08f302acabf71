#ifndef ALIDADE_SRC_MODEL_MOTORS_H_
#define ALIDADE_SRC_MODEL_MOTORS_H_

#include <vector>

#include "alidade/arm.h"

namespace alidade::internal {

/// Joints that an arm may have, whichever file it comes from.
inline constexpr int kMostJoints = 64;

/// How many motors the arm has: as many as joints, or fewer where a matrix with
/// more rows than columns couples them (the axes of a hollow wrist that turn
/// together).
int NumMotors(const Arm& arm);

/// Whether there are fewer motors than joints, so that not all joint values
/// can be reached.
bool HasFewerMotors(const Arm& arm);

/// Of the motors' values: those of the joints of the same numbers, or, where
/// there are fewer, that of the first joint that each of them moves.
std::vector<Dimension> MotorDimensions(const Arm& arm);

/// For solvers that move every joint by itself. @throws InputError where there
/// are fewer motors than joints.
void RequireFreeJoints(const Arm& arm);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_MODEL_MOTORS_H_
