#ifndef ALIDADE_SRC_PLANNING_PLAN_CONFIG_H_
#define ALIDADE_SRC_PLANNING_PLAN_CONFIG_H_

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/plan_options.h"
#include "alidade/plan_result.h"
#include "src/calibration/calibration_task.h"

namespace alidade::internal {

/// Where predictions are to be good: poses drawn within these joint limits
/// whose target is in one of the boxes.
struct PlanRegion {
  /// One pair of limits per joint (rad, m); empty: those of the arm.
  std::vector<std::pair<double, double>> joint_limits;
  std::vector<WorkspaceBox> boxes;  ///< base frame (m); empty: anywhere
  int count = 1000;
};

/// What `plan` is asked for, its files loaded and checked.
struct PlanConfig {
  std::string path;
  std::string title;
  /// Arm, references, what was measured already (`data`, which may have no
  /// poses) and what is to be identified.
  CalibrationTask job;
  PoseMeasurement measurement;
  CandidateOptions candidates;
  PoseConstraints constraints;
  /// Real configurations to choose from instead of drawn ones (n x N).
  std::optional<Eigen::MatrixXd> given_candidates;
  DesignOptions design;
  /// Worst predicted standard deviation over the region (m): so many poses are
  /// planned that it is met. Then design.num_poses is the most allowed.
  std::optional<double> wanted;
  Eigen::VectorXd minimum_motion;  ///< DesignProblem's
  PlanRegion region;
  /// Numbers of poses on the curve, ascending; empty: chosen by the program.
  std::vector<int> curve;
  bool with_curve = true;
  /// One per joint (rad/s, m/s); empty: all the same.
  Eigen::VectorXd speeds;
  std::uint64_t seed = 1;
  std::vector<std::string> input_files;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_CONFIG_H_
