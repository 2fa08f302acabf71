#ifndef ALIDADE_PLAN_H_
#define ALIDADE_PLAN_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"
#include "alidade/dataset.h"
#include "alidade/identifiability.h"
#include "alidade/units.h"
#include "alidade/workspace_box.h"

namespace alidade {

/// What a good plan is, in terms of the p eigenvalues l_1 >= ... >= l_p of the
/// information matrix M (the squares of the singular values s of the whitened,
/// scaled Jacobian):
///
///   kD    det M                    all parameters together; O1 is its root
///   kA    1 / trace M^-1           mean variance of the scaled parameters
///   kE    l_p                      the worst determined combination
///   kG    1 / max_x trace W_x M^-1 W_x^T    worst predicted position variance
///   kI    1 / mean_x trace W_x M^-1 W_x^T   mean predicted position variance
///   kO2   s_p / s_1                condition number
///   kO3   s_p                      the plans of kE
///   kO4   s_p^2 / s_1
///   kO5   1 / sum 1 / s_i
///
/// all to be large. x are the poses of a region, W_x their position rows.
/// Sources of O1 to O5: ObservabilityIndices; of D, A, E, G, I: Pukelsheim
/// 1993, "Optimal design of experiments". D does not depend on the units of the
/// parameters, nor do G and I; the others do, and mean scaled ones.
enum class DesignCriterion { kD, kA, kE, kG, kI, kO2, kO3, kO4, kO5 };

/// Whether the criterion looks at a region.
bool NeedsRegion(DesignCriterion criterion);

/// What is going to be measured at every planned pose.
struct PoseMeasurement {
  double sigma = 1e-3;  ///< of each coordinate (m)
  /// Orientations are measured too.
  bool orientation = false;
  double rotation_sigma = 1e-3;  ///< of each component of it (rad)
  std::vector<int> targets = {0};
  /// Coordinates x, y, z of the instrument's frame that are measured; an
  /// orientation is measured as a whole.
  std::array<bool, 3> axes = {true, true, true};

  /// Scalar measurements at a pose.
  int num_equations() const;
};

/// A floor or a wall in the base frame: the origins of all link frames beyond
/// the first joint's and all targets keep to n . p >= offset + margin (m). The
/// margin stands for the thickness of the links.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< norm 1
  double offset = 0.0;
  double margin = 0.0;
};

/// The instrument sees a target that looks at it: the angle between the
/// direction `axis` of the target's frame and the way from the target to the
/// instrument is at most `angle` (rad).
struct Visibility {
  Eigen::Vector3d instrument = Eigen::Vector3d::Zero();  ///< base frame (m)
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();       ///< norm 1
  double angle = 0.0;
};

/// What a pose must satisfy besides the joint limits. Nothing is demanded of
/// the way between two poses.
struct PoseConstraints {
  /// The targets that are measured, which boxes and visibility are about.
  std::vector<int> targets = {0};
  /// Each of the targets is in one of them; empty: anywhere.
  std::vector<WorkspaceBox> boxes;
  std::vector<HalfSpace> half_spaces;
  std::optional<Visibility> visibility;

  bool empty() const {
    return boxes.empty() && half_spaces.empty() && !visibility;
  }
};

struct CandidateOptions {
  int count = 10000;
  std::uint64_t seed = 1;
  /// Every other candidate has each joint at its lower limit, at its upper one
  /// or in between, a third of the joints each: information is largest at
  /// the limits more often than anywhere else.
  bool limit_faces = true;
  /// Decimals of deg or mm that the motors' values are rounded to, so that
  /// what is planned is what is commanded.
  int joint_decimals = 4;
  /// Draws for each candidate before the constraints count as impossible.
  int max_draws = 1000;
};

struct DesignOptions {
  DesignCriterion criterion = DesignCriterion::kD;
  int num_poses = 0;
  /// A pose may be chosen several times: measured again, it determines as much
  /// as a new one, and where theory puts the best plan there are often fewer
  /// different poses than are to be measured.
  bool allow_repeats = true;
  /// Starts of the exchange, the best counts. The first is greedy; others draw
  /// half of the poses and choose the rest greedily.
  int starts = 4;
  std::uint64_t seed = 1;
  /// Criteria without a cheap update (all but D) are evaluated for so many
  /// candidates at a time, those with the largest slope of the criterion.
  int shortlist = 24;
  /// Rounds over all poses of the plan in a start, at most.
  int max_passes = 60;
  int num_threads = 1;

  /// False with a message that names the field, its value and the constraint.
  bool IsValid(std::string* error) const;
};

/// Where predictions are to be good: poses drawn within these joint limits
/// whose target is in one of the boxes.
struct PlanRegion {
  /// One pair of limits per joint (rad, m); empty: those of the arm.
  std::vector<std::pair<double, double>> joint_limits;
  std::vector<WorkspaceBox> boxes;  ///< base frame (m); empty: anywhere
  int count = 1000;
};

/// What to plan, and from which candidates.
struct PlanOptions {
  PoseMeasurement measurement;
  CandidateOptions candidates;
  PoseConstraints constraints;
  /// Real configurations to choose from instead of drawn ones (n x N).
  std::optional<Eigen::MatrixXd> given_candidates;
  DesignOptions design;
  /// Worst predicted standard deviation over the region (m): so many poses are
  /// planned that it is met. Then design.num_poses is the most allowed.
  std::optional<double> wanted;
  /// Two different poses of the plan differ in at least one joint by this much
  /// (rad, m; one per joint); empty: no such demand.
  Eigen::VectorXd minimum_motion;
  PlanRegion region;
  /// Numbers of poses on the curve, ascending; empty: chosen by the program.
  std::vector<int> curve;
  bool with_curve = true;
  /// One per joint (rad/s, m/s); empty: all the same.
  Eigen::VectorXd speeds;
  /// About how thick links are, for LinkCaution (m); 0: it is not looked at;
  /// none: a twentieth of all lengths of the chain.
  std::optional<double> link_radius;
  std::uint64_t seed = 1;
};

/// Predicted standard deviations of the position of the first target after a
/// calibration from some poses, the root of the sum of the three axes'
/// variances (m): the largest and the root mean square over many poses.
/// Infinite where the poses do not determine all parameters.
struct PredictedAccuracy {
  double worst = std::numeric_limits<double>::infinity();
  double rms = std::numeric_limits<double>::infinity();
};

/// Some poses to measure, and what they would determine.
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
  std::string identified_combination;
};

/// An error term of the plan (error_terms.h): a compliance, a harmonic, or all
/// of a joint's function.
struct PlannedErrorTerm {
  std::string name;  ///< "k2_z", "e3"
  std::string unit;  ///< "rad", "rad/(N m)"
  double prior_std = 0.0;
  double planned_std = 0.0;  ///< predicted; of a function its root mean square
  /// So many poses of this kind halve the prior deviation, or more where other
  /// terms have to be separated from it; 0 = no number does.
  int poses_needed = 0;
};

/// Two links that may be in each other's way at a planned pose.
struct LinkOverlap {
  int pose = 0;  ///< from 1, in the order to be measured
  /// "base" or "link 3", which moves with joint 3; the last one has the tool.
  std::string first;
  std::string second;
  double overlap = 0.0;  ///< of their capsules (m)
};

/// Where the arm may collide with itself, by a rough model of it: links are
/// capsules about the segments between the origins of consecutive joints, all
/// of one radius. What is found may be free, and what is not found may collide.
struct LinkCaution {
  double radius = 0.0;  ///< (m); 0: not looked at
  std::vector<LinkOverlap> overlaps;
};

enum class PlanStatus {
  kDone,
  /// The identifiability analysis wants a choice by the user, or the wanted
  /// accuracy needs more poses than allowed.
  kRefused,
  kFailed,  ///< no plan of as many poses distinguishes all parameters
};

/// What PlanPoses found. SI units.
struct PlanResult {
  PlanStatus status = PlanStatus::kFailed;
  std::string message;  ///< empty when done
  /// The poses in order as a data set in which nothing is measured yet.
  Dataset sheet;
  Arm planned_arm;         ///< as planned with
  int joint_decimals = 0;  ///< that state the sheet's joint values exactly

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
  std::vector<PlannedErrorTerm> terms;       ///< that were asked for
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
  LinkCaution links;
  std::vector<std::string> warnings;

  double plan_time_s = 0.0;  ///< candidates' rows and choice
  double total_time_s = 0.0;
};

/// Chooses poses to measure: draws or takes the candidates, finds what can be
/// identified from them and from the poses of `measured` (which may have
/// none), chooses by Fedorov's exchange, orders for short travel, and evaluates
/// the plan over the candidates and over the region (by default all that the
/// joint limits allow) beside the greedy plan and random poses. The options of
/// the calibration say which parameters are candidates, their priors, and the
/// number of threads, on which results do not depend. Reads and writes no file.
///
/// Costs O(candidates p^2) for each round of the exchange (docs/planning.md).
/// @throws InputError where no candidate satisfies the constraints.
PlanResult PlanPoses(const Arm& arm, const CalibrationData& measured,
                     const CalibrationOptions& calibration,
                     const PlanOptions& options);

}  // namespace alidade

#endif  // ALIDADE_PLAN_H_
