#ifndef ALIDADE_SRC_CALIBRATION_POSE_PERFORMANCE_H_
#define ALIDADE_SRC_CALIBRATION_POSE_PERFORMANCE_H_

#include <optional>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Pose accuracy and pose repeatability of the configurations that were
/// measured at least three times, whole positions of one target at the same
/// joint values to the bit (ISO 9283:1998); of two, S_l is zero whatever they
/// are. Rejected observations, among `outliers`, do not count. With attained
/// positions p_j, j = 1..n, their barycentre p and the commanded position c,
/// which the model predicts,
///
///   AP_p = |p - c|                                            (7.2.1)
///   l_j  = |p_j - p|, l their mean,
///   S_l  = sqrt(sum (l_j - l)^2 / (n - 1)), RP_l = l + 3 S_l  (7.2.2)
///
/// and of each component a, b, c of the rotation vectors from the commanded to
/// the attained orientations AP_a = mean, RP_a = 3 S_a. Nothing where no
/// configuration was repeated, or of more than 200 000 observations.
/// O(N log N).
std::optional<PosePerformanceSummary> MeasurePosePerformance(
    const std::string& poses, const EvaluatedSet& set,
    const std::vector<Outlier>& outliers);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_POSE_PERFORMANCE_H_
