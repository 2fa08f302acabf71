#include "alidade/model/arm.h"

#include <algorithm>
#include <cmath>

namespace alidade {

double Reach(const Arm& arm) {
  double reach = arm.instrument_from_base.translation().norm() +
                 arm.last_from_target.translation().norm();
  for (const Joint& joint : arm.joints) {
    reach += std::abs(joint.d) + std::abs(joint.r);
    if (joint.type == JointType::kPrismatic && std::isfinite(joint.lower) &&
        std::isfinite(joint.upper)) {
      reach += std::max(std::abs(joint.lower), std::abs(joint.upper));
    }
  }
  return reach > 0.0 ? reach : 1.0;
}

}  // namespace alidade
