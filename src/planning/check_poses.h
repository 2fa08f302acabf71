#ifndef ALIDADE_SRC_PLANNING_CHECK_POSES_H_
#define ALIDADE_SRC_PLANNING_CHECK_POSES_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "src/kernel/measurement_model.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// What the poses of a check are chosen from, and by what.
struct CheckPoseOptions {
  int num_poses = 10;
  /// Columns that are found from the check (ArmCheckOptions).
  std::vector<int> refitted;
  double noise = 1e-4;  ///< standard deviation of a measured coordinate (m)
  int num_candidates = 4000;
  int joint_decimals = 4;
  std::uint64_t seed = 1;
  int num_threads = 1;
};

/// The poses (n x num_poses, in an order with little travel) that show best
/// whether an arm is as calibrated. Of candidates drawn within the joint limits
/// of the calibrated arm, those where the calibration moves the target by the
/// median or more; of these the D-optimal plan for changes of all joint
/// parameters (0.5 mrad, 0.2 mm) and what is refitted, each pose with the
/// accuracy that is predicted there (ChoosePoses).
/// `calibrated`, `uncalibrated`: as in CheckArm.
Eigen::MatrixXd ChooseCheckPoses(const MeasurementModel& calibrated,
                                 const MeasurementModel& uncalibrated,
                                 const ParameterCovariance& covariance,
                                 const CheckPoseOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_CHECK_POSES_H_
