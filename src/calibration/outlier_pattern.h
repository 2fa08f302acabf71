#ifndef ALIDADE_SRC_CALIBRATION_OUTLIER_PATTERN_H_
#define ALIDADE_SRC_CALIBRATION_OUTLIER_PATTERN_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// What rejected observations have in common: the joint value, or the moment of
/// gravity about a joint's axis, whose ranks among all poses differ most
/// between them and the others (Wilcoxon's rank-sum test, corrected for as many
/// tests), as "the gravity moment of joint 2"; empty where p >= 1e-4, or fewer
/// than five were rejected. What follows a moment is elastic, and is no mistake
/// of measurement. O(N log N).
std::string PatternOf(const Arm& arm, const Dataset& data,
                      const std::vector<Outlier>& outliers);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_OUTLIER_PATTERN_H_
