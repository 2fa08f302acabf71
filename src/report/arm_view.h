#ifndef ALIDADE_SRC_REPORT_ARM_VIEW_H_
#define ALIDADE_SRC_REPORT_ARM_VIEW_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// The arm as a chain of links at some poses of a set, in the instrument's
/// frame (m).
struct ArmPicture {
  std::vector<int> poses;  ///< from 1
  /// One entry per pose: the corners from the base to the target.
  std::vector<Eigen::Matrix3Xd> lines;
};

/// At up to 60 poses; empty where the set's joint values are not this arm's.
ArmPicture PictureOf(const Arm& arm, const EvaluatedSet& set);

/// What the page's script draws the arm and its errors from, in mm and in the
/// frame of the base: {"lines": {pose: [corners]}, "places": [[pose, position,
/// error before, error after]]}, at most 400 of the training poses. Empty where
/// there is nothing to draw.
std::string ArmViewJson(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_ARM_VIEW_H_
