#ifndef ALIDADE_PLAN_RESULT_H_
#define ALIDADE_PLAN_RESULT_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/identifiability_result.h"
#include "alidade/units.h"

namespace alidade {

/// Predicted standard deviations of the position of the first target after a
/// calibration from some poses, the root of the sum of the three axes'
/// variances (m): the largest and the root mean square over many poses.
/// Infinite where the poses do not tell all parameters apart.
struct PredictedAccuracy {
  double worst = std::numeric_limits<double>::infinity();
  double rms = std::numeric_limits<double>::infinity();
};

/// Some poses to measure, and what they would tell.
struct PlanEvaluation {
  std::string name;  ///< "planned", "greedy", "random (median of 20)"
  PredictedAccuracy candidates;
  PredictedAccuracy region;
  /// Of the scaled Jacobian of these poses alone, whitened.
  ObservabilityIndices observability;
};

/// Accuracy by the number of poses.
struct PlanCurvePoint {
  int num_poses = 0;
  PredictedAccuracy planned;  ///< over the region
  PredictedAccuracy random;   ///< the medians of several draws
  double bound = 0.0;         ///< PlanResult::bound of so many poses; 0 = none
};

struct PlannedParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  double prior_std = std::numeric_limits<double>::infinity();
  double planned_std = 0.0;  ///< predicted (rad, m)
  double random_std = 0.0;   ///< the median of several draws of as many poses
  std::string stands_for;
};

/// What `plan` found. SI units.
struct PlanResult {
  std::string version;
  std::string command;
  std::string title;
  std::string arm;
  std::vector<InputFile> inputs;
  std::uint64_t seed = 0;

  std::string criterion;        ///< "D", "G" ...
  std::string measured;         ///< "position", "pose"
  double sigma = 0.0;           ///< of a coordinate (m)
  double rotation_sigma = 0.0;  ///< (rad); 0 = orientations are not measured
  int equations = 0;            ///< scalar measurements at a pose
  int num_candidates = 0;
  std::int64_t num_looked_at = 0;  ///< draws, or rows of the file
  int measured_before = 0;         ///< poses that were measured already
  bool has_priors = false;
  bool allow_repeats = true;
  double wanted = 0.0;  ///< worst accuracy asked for (m); 0 = none

  /// Joint values n x N (rad or m) in the order to be measured, and the
  /// predicted standard deviation of the position at each (m).
  std::vector<Dimension> joint_dimensions;
  Eigen::MatrixXd joint_values;
  Eigen::VectorXd pose_std;
  int num_distinct = 0;  ///< poses without repeats
  /// Sum over the moves of the largest joint's way (rad, or m of a joint that
  /// slides; seconds where speeds are given), as drawn and as ordered.
  double travel_before = 0.0;
  double travel = 0.0;
  bool travel_in_seconds = false;

  std::vector<PlannedParameter> parameters;  ///< the free ones
  std::vector<PlanEvaluation> evaluations;   ///< planned first
  /// No plan of as many poses has a smaller worst standard deviation over the
  /// candidates than sigma sqrt(p / N) (Kiefer and Wolfowitz 1960); 0 where
  /// priors, earlier poses or what is measured make that no bound.
  double bound = 0.0;
  /// The plan has at least this part of the information (p-th root of det M)
  /// that any plan of as many of these candidates could have.
  double d_efficiency = 0.0;
  bool converged = true;
  int exchanges = 0;
  int passes = 0;
  /// log of the criterion: of the greedy plan, of the one found.
  double greedy_value = 0.0;
  double value = 0.0;
  std::vector<PlanCurvePoint> curve;
  std::vector<std::string> warnings;

  double plan_time_s = 0.0;  ///< candidates' rows and choice
  double total_time_s = 0.0;
};

}  // namespace alidade

#endif  // ALIDADE_PLAN_RESULT_H_
