#ifndef ALIDADE_CALIBRATION_RESULT_H_
#define ALIDADE_CALIBRATION_RESULT_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"
#include "alidade/dataset.h"
#include "alidade/identifiability.h"
#include "alidade/shared_matrix.h"
#include "alidade/solver.h"
#include "alidade/uncertainty.h"
#include "alidade/units.h"

namespace alidade {

/// How serious a finding is, from best to worst.
enum class FindingLevel {
  kPassed,     ///< as it should be
  kNote,       ///< worth knowing, but no reason to doubt the result
  kAttention,  ///< to be looked at before the result is used
  kFailed,     ///< a reason not to use the result
};

/// "passed", "note", "attention", "failed".
const char* ToString(FindingLevel level);

/// One judgement: what was computed, what it was compared with, and in words.
struct Finding {
  /// "solver", "improvement", "acceptance.validation_max" ... (docs/files.md).
  std::string key;
  /// SI units, or a ratio, a p-value or a number of standard deviations; NaN
  /// where no number decides.
  double statistic = std::numeric_limits<double>::quiet_NaN();
  double threshold = std::numeric_limits<double>::quiet_NaN();
  std::string sentence;
  FindingLevel level = FindingLevel::kPassed;
  /// What to do about it, a sentence; may be empty below kAttention.
  std::string next = "";
};

/// What a verdict comes to.
enum class VerdictDecision { kAccepted, kAcceptedWithWarnings, kRejected };

/// Whether a result may be used. `level` is that of the worst finding, a note
/// counting as passed; findings come in the order of their weight.
struct Verdict {
  FindingLevel level = FindingLevel::kFailed;
  std::string title;     ///< "Accepted", "Usable, with warnings" ...
  std::string sentence;  ///< what the calibration achieved; may be several
  std::vector<Finding> findings;

  VerdictDecision decision() const;
};

/// A file that a result was computed from.
struct InputFile {
  std::string path;    ///< as the user wrote it
  std::string sha256;  ///< 64 hexadecimal digits
};

/// How a parameter of a result came to its value.
enum class ParameterAssessment {
  kKnown,           ///< not among the parameters to estimate
  kFixed,           ///< held at its nominal value
  kWeak,            ///< weakly identifiable: these data hardly determine it
  kPriorDominated,  ///< the prior has more than half of the information
  kEstimated,       ///< determined by the data
};

/// One parameter of the calibrated arm (rad or m by `dimension`).
struct ParameterResult {
  std::string name;
  std::string kind;  ///< block it belongs to: "beta" ... "r", "base", "tool"
  Dimension dimension = Dimension::kLength;
  double nominal = 0.0;
  double value = 0.0;
  /// Standard deviation; NaN where it is not computed or does not apply.
  double std = std::numeric_limits<double>::quiet_NaN();
  /// The true value, where the job knows it (a simulated arm).
  std::optional<double> truth;
  /// The value that a publication states, where the job names one.
  std::optional<double> published;
  ParameterDecision decision;
  ParameterAssessment assessment = ParameterAssessment::kKnown;

  double deviation() const { return value - nominal; }
};

/// What one observation is of.
struct ObservationLabel {
  std::string kind;           ///< "position", "pose", "distance" ...
  int pose = 0;               ///< column of joint_values; -1: of none
  std::string target;         ///< its name, empty where it has none
  std::string where;          ///< "file:line", empty where not read from a file
  bool has_length = true;     ///< a length was measured, if only one axis
  bool has_rotation = false;  ///< an orientation was measured
};

/// Errors without the observations that the robust loss has rejected.
struct KeptErrors {
  std::int64_t num_rejected = 0;
  Accuracy before;
  Accuracy after;
  Accuracy rotation_before;  ///< (rad); n = 0 without orientations
  Accuracy rotation_after;
  double change_t = std::numeric_limits<double>::quiet_NaN();
};

/// The error of the arm, before and after calibration, at the poses of one
/// data set. All lengths in m, all angles in rad. Matrices may share their
/// numbers with the data set that was evaluated.
struct EvaluatedSet {
  std::string name;           ///< file of the poses
  SharedMatrix joint_values;  ///< one column per pose
  /// What each joint value measures, one per row of `joint_values`.
  std::vector<Dimension> joint_dimensions;
  /// One entry per observation, as are the columns below; empty where they are
  /// one position per pose.
  std::vector<ObservationLabel> labels;
  /// Measured, or true where simulated; NaN where no position was measured.
  SharedMatrix positions;
  SharedMatrix residual_before;  ///< predicted - measured, lengths
  SharedMatrix residual_after;
  /// Rotation vectors of measured orientations, zero of other observations;
  /// empty where no orientation was measured.
  SharedMatrix rotation_residual_before;
  SharedMatrix rotation_residual_after;
  Accuracy before;
  Accuracy after;
  Accuracy rotation_before;  ///< (rad); n = 0 without orientations
  Accuracy rotation_after;
  /// Mean change of the error, after less before, in its standard errors:
  /// whether the calibration made a difference here. Positive = worse; NaN
  /// where fewer than two lengths were measured.
  double change_t = std::numeric_limits<double>::quiet_NaN();
  /// Where some were rejected: what a result is judged by.
  std::optional<KeptErrors> kept;

  /// `kept` or, where nothing was rejected, the errors of all observations.
  KeptErrors Judged() const;
  SharedVector ErrorBefore() const;
  SharedVector ErrorAfter() const;
};

/// One solver on the training data.
struct SolverRun {
  SolverSummary summary;
  Eigen::VectorXd values;  ///< all parameters of the layout
  Accuracy train;          ///< with these values
};

/// One acceptance limit of the job (m, rad).
struct AcceptanceCheck {
  std::string quantity;  ///< "train_max", "validation_rms" ...
  double limit = 0.0;
  double obtained = 0.0;
  Dimension dimension = Dimension::kLength;
  /// Observations that were rejected and did not count.
  std::int64_t num_rejected = 0;
  bool met() const { return obtained <= limit; }
};

/// How accurate the arm is with so much of it calibrated.
struct StageResult {
  std::string name;  ///< "frames only", "joint offsets", "all geometry"
  int num_free = 0;  ///< parameters solved for
  Accuracy train;
  Accuracy validation;      ///< n = 0 without validation poses
  Accuracy train_rotation;  ///< (rad); n = 0 without orientations
  Accuracy validation_rotation;
};

/// A point or a plane that was measured against, in the instrument's frame.
struct ReferenceResult {
  std::string block;  ///< of its parameters: "point1", "plane2"
  std::string name;
  bool is_known = false;
  /// Of a point its position (m), of a plane its unit normal.
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  /// Of a plane (m); NaN for points.
  double offset = std::numeric_limits<double>::quiet_NaN();
};

/// Errors of poses that were each left out of one fit, without what the fit to
/// all of them has rejected.
struct KeptCrossValidation {
  std::int64_t num_rejected = 0;
  Accuracy position;
  Accuracy rotation;  ///< (rad); n = 0 without orientations
};

/// Errors of poses that were each left out of one fit.
struct CrossValidation {
  int folds = 0;
  Accuracy position;
  Accuracy rotation;  ///< (rad); n = 0 without orientations
  std::optional<KeptCrossValidation> kept = {};  ///< where some were rejected
};

/// One set of error terms that was weighed against others.
struct ErrorRung {
  std::string name;  ///< "geometry", "elasticity", "elasticity + functions" ...
  int num_terms = 0;    ///< coefficients besides the geometry
  double weight = 0.0;  ///< in what is delivered
  /// By how much it makes -2 log of the restricted likelihood of the training
  /// poses smaller than the geometry alone does.
  double evidence = 0.0;
  /// False where a rung with fewer terms has as much evidence (error_fit.h): it
  /// has no weight, and its errors without training poses are not computed, 0.
  bool is_weighed = true;
  /// Standard deviations of the coefficients' priors, found from the training
  /// poses: compliances about the joint's axis and the others (rad / (N m)),
  /// functions (rad); 0 = none of them.
  double compliance_std = 0.0;
  double other_compliance_std = 0.0;
  double function_std = 0.0;
  /// Mean error of training poses that it was fitted without (m): regions of
  /// joint space, and random folds.
  double region_error = 0.0;
  double random_error = 0.0;
  Accuracy train;
  Accuracy validation;  ///< n = 0 without validation poses
  Accuracy validation_rotation;
};

/// A coefficient of the error terms as delivered. Names are those of
/// parameters: of joint 2 "k2_x" "k2_y" "k2_z" its compliances, "h2_c1" "h2_s1"
/// cosine and sine of one cycle per turn, "b2" backlash, "g2" its scale, "g2_3"
/// what it moves with joint 3.
struct ErrorTermEstimate {
  std::string name;
  double value = 0.0;
  double std = std::numeric_limits<double>::quiet_NaN();
  std::string unit;  ///< of both: "rad/(N m)", "rad", "1", "m/rad" or "rad/m"
};

/// How far error terms move the first target: over poses drawn within the joint
/// limits, the distance between its positions with and without them (m).
struct ErrorTermEffect {
  int joint = 0;  ///< from 1; 0 = all of them together
  /// "elasticity", "function", "harmonics", "scale and coupling", "backlash";
  /// "all" of the joint.
  std::string term;
  double rms = 0.0;
  double max = 0.0;
};

/// Values of a joint without a gap in the training poses (rad, m).
struct MeasuredRange {
  int joint = 0;  ///< from 1
  double lower = 0.0;
  double upper = 0.0;
};

/// Measured minus predicted, as what each joint would have to turn further (or
/// slide) to take most of it away, at an even sample of the training poses. NaN
/// where the joint hardly moves what was measured.
struct JointResiduals {
  std::vector<int> poses;        ///< columns of the training poses
  Eigen::MatrixXd joint_values;  ///< n x poses (rad, m)
  Eigen::MatrixXd geometry;      ///< n x poses, with geometry alone (rad, m)
  Eigen::MatrixXd remaining;     ///< the same with the error terms
};

/// What became of the error terms.
struct ErrorTermsResult {
  /// How much of the step from geometry alone to the stack of rungs is taken,
  /// by its evidence: 0 = nothing, the arm is rigid.
  double share = 0.0;
  double t_regions = 0.0;        ///< evidence of the gain in regions left out
  double t_random = 0.0;         ///< in random folds
  double effective_terms = 0.0;  ///< coefficients that the data decide
  std::string sentence;
  std::vector<ErrorRung> rungs;
  /// Those of a rung, of what is delivered; 0 where nothing was left out.
  double region_error = 0.0;
  double random_error = 0.0;
  /// What follows is empty where the arm stays rigid. The functions are the
  /// arm's (`CalibrationResult::arm`).
  std::vector<ErrorTermEstimate> terms;
  std::vector<ErrorTermEffect> effects;
  std::vector<MeasuredRange> measured;
  JointResiduals residuals;
};

/// Factors that priors of the joints were multiplied by, where they were found
/// from the data.
struct PriorScaling {
  double angle = 1.0;
  double length = 1.0;
};

/// What measurements of the same configuration differ by: the instrument and
/// the arm's own repeatability, no geometry. Zero degrees of freedom: nothing
/// was repeated.
struct RepeatSpread {
  double length = 0.0;  ///< standard deviation of a coordinate (m)
  std::int64_t length_degrees_of_freedom = 0;
  double rotation = 0.0;  ///< of a component of the rotation vector (rad)
  std::int64_t rotation_degrees_of_freedom = 0;
};

/// Pose accuracy and repeatability of one configuration that was measured more
/// than once (ISO 9283:1998, 7.2.1 and 7.2.2). Commanded is the pose that the
/// arm's model predicts; angles are components of rotation vectors about the
/// instrument's axes.
struct PosePerformance {
  int pose = 0;                ///< the first of them, column of joint_values
  std::string target;          ///< its name, empty where it has none
  std::int64_t n = 0;          ///< measurements
  double before = 0.0;         ///< AP_p, by the nominal arm (m)
  double accuracy = 0.0;       ///< AP_p, by the calibrated one (m)
  double mean_distance = 0.0;  ///< from the barycentre, l (m)
  double distance_std = 0.0;   ///< S_l (m)
  double repeatability() const { return mean_distance + 3.0 * distance_std; }
  /// AP_a, AP_b, AP_c after calibration and their RP = 3 S (rad); NaN where no
  /// orientations were measured.
  Eigen::Vector3d rotation_accuracy =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Vector3d rotation_repeatability = rotation_accuracy;
};

/// The same over all configurations of a data set that were repeated.
struct PosePerformanceSummary {
  std::string poses;                ///< "training" or "validation"
  std::int64_t configurations = 0;  ///< measured at least three times
  std::int64_t fewest = 0;          ///< measurements of one of them
  Accuracy before;                  ///< of AP_p (m)
  Accuracy accuracy;
  Accuracy repeatability;  ///< of RP_l (m)
  /// The first thousand of them.
  std::vector<PosePerformance> each;
};

/// An observation whose residual is beyond what chance allows.
struct Outlier {
  std::int64_t observation = 0;  ///< of its data set, from 0
  ObservationLabel label;
  double error = 0.0;  ///< in length (m)
  /// Norm of the whitened residual; of a validation pose, in predicted standard
  /// deviations.
  double standardised = 0.0;
  double weight = 1.0;  ///< that the robust loss leaves it
};

/// One quantity that a publication states, in its own words.
struct PublishedFigure {
  std::string quantity;  ///< one of those in docs/files.md
  std::string published;
};

/// What a publication says of the same calibration: the `published` of a job.
struct PublishedStudy {
  std::string source;
  /// Deviations from nominal as its table prints them, one per column of the
  /// layout; zero where it states none.
  Eigen::VectorXd deviations;
  int angle_decimals = 4;   ///< of rad
  int length_decimals = 1;  ///< of mm
  int baseline_iterations = 100;
  double baseline_time_s = 0.0;
  std::vector<PublishedFigure> figures;
};

enum class CalibrationStatus {
  kNotRun,        ///< sentinel: nothing has happened yet
  kDone,          ///< calibrated, all acceptance limits met
  kMissedLimits,  ///< calibrated, but an acceptance limit is missed
  kRefused,       ///< the identifiability analysis wants a choice by the user
  kFailed,        ///< the solver found no usable solution
};

/// "not run", "done", "missed acceptance limits" ...
const char* ToString(CalibrationStatus status);

/// Everything a calibration found out. It is as complete as the calibration
/// got: a refused one holds the identifiability analysis, a failed one the
/// solver's summary too. SI units.
struct CalibrationResult {
  CalibrationStatus status = CalibrationStatus::kNotRun;
  std::string message;  ///< why the status is not kDone, else empty

  /// Where the result comes from. Of these, Calibrate knows the version of
  /// the library, the name of the arm and the seed; who reads files fills in
  /// the rest.
  std::string version;
  std::string command;
  std::string title;
  std::string arm_name;
  std::vector<InputFile> inputs;
  std::uint64_t seed = 0;

  Arm arm;  ///< calibrated; the nominal one where the result is not usable

  std::vector<ParameterResult> parameters;
  IdentifiabilityResult identifiability;
  /// The first is the job's own solver, whose values the result holds; then
  /// those it is compared with.
  std::vector<SolverRun> runs;
  EvaluatedSet train;
  std::optional<EvaluatedSet> validation;
  /// What "before" is where it is not the nominal arm as it stands in its file.
  std::string before_note;
  /// Where base or tool are fitted: what each part of a calibration brings.
  std::vector<StageResult> stages;
  std::optional<CrossValidation> cross_validation;
  std::optional<PriorScaling> prior_scaling;
  /// Where they were asked for.
  std::optional<ErrorTermsResult> error_terms;
  RepeatSpread repeats;
  /// Of training and validation poses that were repeated.
  std::vector<PosePerformanceSummary> pose_performance;
  std::vector<RejectedRow> rejected;
  /// What people call the targets and references: {"point1", "A"}.
  std::vector<std::pair<std::string, std::string>> aliases;
  std::vector<ReferenceResult> references;  ///< as calibrated
  /// Norm of a whitened residual beyond which one of all observations would be
  /// by chance in 5 % of calibrations; 0 = not looked at.
  double outlier_limit = 0.0;
  std::vector<Outlier> outliers;  ///< of the training data, worst first
  std::vector<Outlier> validation_outliers;
  /// Standard deviation of a coordinate, where the job asked for an estimate
  /// (m); 0 = given.
  double estimated_sigma = 0.0;
  /// The same of a component of an orientation (rad).
  double estimated_rotation_sigma = 0.0;
  /// Median sigma that the fit took of a coordinate (m); 0 = no lengths.
  double sigma = 0.0;
  /// Chi-square of the fit over its degrees of freedom, priors accounted for;
  /// 0 where no freedom is left.
  double reduced_chi_square = 0.0;
  /// Nothing without a usable solution.
  std::optional<UncertaintyResult> uncertainty;
  /// Where the `published` values of the parameters come from; may be empty.
  std::string published_source;
  std::vector<AcceptanceCheck> acceptance;
  /// What speaks against the result although a solver calls it usable.
  std::vector<std::string> warnings;
  /// Checks of the input that found something: measurements that do not fit the
  /// arm, lost targets, repeated data. Their sentences are among the warnings.
  std::vector<Finding> plausibility;
  Verdict verdict;

  double identify_time_s = 0.0;
  double total_time_s = 0.0;

  bool accepted() const;
  /// Whether a solver found a solution that may be used; acceptance limits do
  /// not matter.
  bool IsUsable() const;
  /// Whether there is a solution, complete with its accuracy, that must not be
  /// used: `message` says why.
  bool IsRejected() const;
  /// By name ("d3"). @pre the layout has it, and the result is usable.
  const ParameterResult& Parameter(const std::string& name) const;
  /// Its confidence interval (CalibrationOptions::uncertainty); NaN where the
  /// parameter is not estimated or uncertainties were not asked for.
  ConfidenceInterval Interval(const std::string& name) const;
  /// One line: status, and the accuracy before and after.
  std::string BriefReport() const;
  /// Status, verdict, accuracy, the estimated parameters with their standard
  /// deviations, outliers and every warning: for a log or a terminal.
  std::string FullReport() const;
};

}  // namespace alidade

#endif  // ALIDADE_CALIBRATION_RESULT_H_
