#ifndef ALIDADE_SRC_MODEL_JOINT_DRAW_H_
#define ALIDADE_SRC_MODEL_JOINT_DRAW_H_

#include <Eigen/Core>
#include <cstdint>

#include "alidade/arm.h"
#include "src/common/random.h"

namespace alidade::internal {

/// A value of joint `j` (from 0) drawn uniformly within its limits. Without
/// limits, a revolute joint draws from a full turn and a prismatic one from the
/// reach of the arm to both sides.
double DrawJointValue(const Arm& arm, int j, Random* random);

/// `count` poses (n x count) drawn so. Pose k draws from stream k of the seed.
Eigen::MatrixXd DrawJointValues(const Arm& arm, int count, std::uint64_t seed);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_MODEL_JOINT_DRAW_H_
