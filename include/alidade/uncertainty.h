#ifndef ALIDADE_UNCERTAINTY_H_
#define ALIDADE_UNCERTAINTY_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/units.h"
#include "alidade/workspace_box.h"

namespace alidade {

enum class IntervalMethod {
  /// Profile likelihood for parameters whose nonlinearity is above the limit,
  /// the linear model for all others.
  kAutomatic,
  kLinear,   ///< estimate +- quantile * standard deviation
  kProfile,  ///< profile likelihood for every parameter
};

/// How the uncertainty of a calibration is stated.
struct UncertaintyOptions {
  double confidence = 0.95;  ///< of intervals and ellipsoids; in (0, 1)
  IntervalMethod intervals = IntervalMethod::kAutomatic;
  /// Above this (docs/uncertainty.md) linear intervals no longer hold what they
  /// say: a second-order part of a fifth of the standard deviation takes
  /// about 0.5 to 1 % from a coverage of 95 %.
  double nonlinearity_limit = 0.2;
  /// Configurations that the predicted map is drawn at, within the joint
  /// limits; 0 = no map.
  int map_configurations = 2000;
  std::uint64_t seed = 1;  ///< of these
  /// The task region that the uncertainty budget is stated for; empty: wherever
  /// the joint limits let the first target be.
  std::vector<WorkspaceBox> region;
  /// Configurations of it that the budget is evaluated at; 0 = no budget.
  int region_configurations = 500;
};

/// An interval that holds the true value with the stated confidence; bounds of
/// the value itself (rad, m), not of its deviation from nominal.
struct ConfidenceInterval {
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
  /// By profile likelihood rather than by the linear model.
  bool is_profile = false;
};

/// The uncertainty of one free parameter.
struct ParameterUncertainty {
  std::string name;
  /// Of the parameter, which is that of the combination that it identifies
  /// where others are fixed; infinite where nothing determines it.
  double std = std::numeric_limits<double>::quiet_NaN();
  ConfidenceInterval interval;
  /// Root mean square of the second-order part of the estimate over its first
  /// one (docs/uncertainty.md).
  double nonlinearity = 0.0;
  /// Part of the prior in what is known of it: 0 = the data alone, 1 = the
  /// prior alone.
  double prior_share = 0.0;
  /// The standard deviation by the sandwich over configurations, and over
  /// blocks of neighbouring ones where these are enough, whose errors are
  /// alike. The residuals themselves scale it: it holds where the model lacks
  /// something, if only roughly for few. NaN where it is not computed.
  double robust_std = std::numeric_limits<double>::quiet_NaN();
};

/// Two parameters that are strongly correlated.
struct CorrelatedPair {
  std::string first;
  std::string second;
  double correlation = 0.0;
};

/// Whether numbers look like draws of a distribution; p_value: how often a true
/// one would look worse.
struct TestResult {
  double statistic = 0.0;
  double p_value = std::numeric_limits<double>::quiet_NaN();
};

/// What one pose weighs in a fit.
struct Influence {
  int pose = 0;
  std::string where;    ///< "file:line", empty where not read from a file
  double leverage = 0;  ///< trace of its block of the hat matrix
  double cooks_distance = 0;
  double standardised = 0;  ///< norm of the whitened residual
};

/// Counts of values in bins of equal width: the first bin begins at `lower` and
/// takes in all below it, the last all above.
struct Histogram {
  double lower = -4.0;
  double width = 0.25;
  std::vector<std::int64_t> counts = {};
};

/// Of standardised values, from -4 to 4 in steps of a quarter.
Histogram CountStandardised(const Eigen::VectorXd& values);

/// Of the residuals of a fit, whitened and freed of their own part in it.
struct ResidualDiagnostics {
  double chi_square = 0.0;
  double degrees_of_freedom = 0.0;
  double reduced_chi_square = 0.0;
  /// Two-sided p-value of chi-square; NaN where sigma is estimated from it.
  double chi_square_p_value = std::numeric_limits<double>::quiet_NaN();
  TestResult normality;  ///< Anderson and Darling
  TestResult whiteness;  ///< Ljung and Box, along the order of measurement
  int lags = 0;          ///< of the whiteness test
  /// Studentised residuals of measured rows in the order of observations; of
  /// more than 100 000 observations an even sample.
  Eigen::VectorXd studentised;
  Histogram histogram;  ///< of these
  /// One entry per pose, in the order of poses; none for more observations.
  std::vector<Influence> poses;
};

/// What the residuals of a fit are tested for depending on.
enum class StructureKind {
  kJointValue,     ///< low harmonics of the joint's value: encoder, gear
  kJointRipple,    ///< higher ones, where there are data enough: gear
  kGravityMoment,  ///< the moment of gravity about the joint: elasticity
  kGravitySign,    ///< its sign: backlash
  kApproach,       ///< the direction that the joint came from: backlash
  kRowOrder,       ///< the order of rows: drift, thermal growth
  kCovariate,      ///< a recorded quantity: temperature, time, tilt, payload
};

/// One test of the residuals for structure (residual_structure.h).
struct StructureTest {
  StructureKind kind = StructureKind::kJointValue;
  int joint = 0;                    ///< from 1; 0 = of all joints, or of none
  std::string covariate;            ///< its name, of kCovariate
  double statistic = 0.0;           ///< F
  double degrees_of_freedom = 0.0;  ///< of its numerator
  double p_value = 1.0;             ///< corrected for all tests (Holm)
  double explained = 0.0;           ///< part of the residuals' sum of squares
  /// It is there: the strongest of all, given those found before it.
  bool is_found = false;
};

/// What residuals are compared with.
enum class NoiseSource {
  kNone,       ///< nothing is known of the measurement alone
  kStated,     ///< the sigmas that the data state
  kRepeats,    ///< measurements of the same configuration
  kStructure,  ///< what is left where the structure that was found is taken out
};

/// Whether the residuals are more than the measurement's, and what of. Repeats
/// of a configuration are one look at the arm: their means are looked at.
struct LackOfFit {
  NoiseSource source = NoiseSource::kNone;
  double noise = 0.0;     ///< standard deviation of a measured coordinate (m)
  double residual = 0.0;  ///< of the residuals, degrees of freedom counted (m)
  double degrees_of_freedom = 0.0;
  /// One-sided: how often residuals of a model that lacks nothing are as large.
  double p_value = std::numeric_limits<double>::quiet_NaN();
  /// Variance of the target's position, all three axes, beyond parameters and
  /// measurement (m^2); 0 where it is not significant (5 %).
  double excess_variance = 0.0;
  double rotation_excess_variance = 0.0;  ///< the same of orientations (rad^2)
  /// Of excess_variance, by Welch and Satterthwaite; 0 where it is 0.
  double excess_degrees_of_freedom = 0.0;
  std::int64_t looks = 0;  ///< observations, repeats counted once
  bool is_sample = false;  ///< an even sample of the observations was looked at
  /// Those found first, in the order of their finding, then by p-value.
  std::vector<StructureTest> structure;
};

/// Where a predicted deviation of a position comes from: standard deviations
/// (m), root of the sum over the three axes, root mean square over positions.
struct PredictionParts {
  double from_parameters = 0.0;
  double from_model = 0.0;        ///< from what the model lacks
  double from_measurement = 0.0;  ///< what a measured position has besides
};

/// Predicted standard deviation of the target's position over the workspace
/// (root of the sum of the variances of the three axes, m), of what parameters
/// leave unknown and what the model lacks.
struct PredictedMap {
  Eigen::MatrixXd joint_values;  ///< one column per drawn configuration
  Eigen::Matrix3Xd positions;    ///< in the instrument's frame (m)
  Eigen::VectorXd position_std;  ///< one entry per configuration (m)
  /// Semi-axes of the ellipsoid of one standard deviation, descending.
  Eigen::Matrix3Xd semi_axes;
  Eigen::VectorXd rotation_std;  ///< (rad); empty where no target is turned
  Accuracy summary;              ///< of position_std
  Accuracy rotation_summary;     ///< of rotation_std; n = 0 without
  /// Where the true arm is known: its error at these configurations (m).
  Eigen::VectorXd true_error;
  Accuracy true_summary;  ///< of true_error; n = 0 without
  PredictionParts parts;
};

/// How often something predicted held. In a study of many calibrations the
/// interval is that of the true rate (Clopper and Pearson, 95 %); of one
/// calibration it says between which rates 95 % of all come out where the
/// prediction is right.
struct Coverage {
  std::int64_t held = 0;
  std::int64_t n = 0;
  double lower = 0.0;
  double upper = 1.0;
  double rate() const {
    return n > 0 ? static_cast<double>(held) / static_cast<double>(n) : 0.0;
  }
};

/// Predictions of a calibration against what was then observed.
struct PredictionCheck {
  double confidence = 0.95;
  Coverage axes;        ///< each coordinate within its interval
  Coverage ellipsoids;  ///< each position within its ellipsoid
  /// Deviations over predicted standard deviations, one per coordinate.
  Eigen::VectorXd z_scores;
  Histogram histogram;  ///< of these
  /// Outliers among the observations, which all of this leaves out.
  std::int64_t num_outliers = 0;
  double rms_z = 0.0;  ///< 1 where predicted and observed agree
  /// "agree", "larger" or "smaller" than predicted, and why so.
  std::string verdict;
  PredictionParts parts;  ///< at whole positions
};

/// What an uncertainty budget has contributions of.
enum class BudgetSource {
  kParameters,     ///< what the calibration left unknown of the parameters
  kModel,          ///< what the model lacks
  kRepeatability,  ///< of the arm, from repeated configurations
  /// Residuals of which noise and the model's own errors cannot be separated.
  kResiduals,
  kMeasurement,  ///< the instrument, of one measurement
};

/// How a standard uncertainty was evaluated (JCGM 100:2008, 2.3.2 and 2.3.3).
enum class EvaluationType {
  kA,  ///< by statistics of observations
  kB,  ///< by other means: as it is stated
};

/// One line of the budget, of a coordinate of the target's position. Its
/// sensitivity is 1, but for the parameters, of which each has its own.
struct BudgetContribution {
  BudgetSource source = BudgetSource::kParameters;
  EvaluationType type = EvaluationType::kA;
  /// Standard uncertainty (m), root mean square over the region.
  double std = 0.0;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  std::string basis;  ///< where it comes from, in words
};

/// What a parameter alone contributes: sensitivity * std. The contributions of
/// several do not add up in squares, as their estimates are correlated.
struct ParameterContribution {
  std::string name;
  Dimension dimension = Dimension::kLength;  ///< of the parameter
  double std = 0.0;                          ///< (rad, m)
  /// Root mean square over region and axes of the derivative of a coordinate
  /// (m/rad, 1).
  double sensitivity = 0.0;
  double contribution() const { return sensitivity * std; }
};

/// Of several contributions together (budget.h has the equations).
struct CombinedUncertainty {
  double std = 0.0;  ///< combined standard uncertainty of a coordinate (m)
  /// Effective, by Welch and Satterthwaite.
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  double coverage_factor = 0.0;
  double expanded = 0.0;  ///< coverage_factor * std (m)
  /// Radius about a predicted position that holds the true one (m).
  double expanded_distance = 0.0;
};

/// Uncertainty of the first target's position over the task region, by JCGM
/// 100:2008 (GUM).
struct UncertaintyBudget {
  std::vector<WorkspaceBox> region;  ///< empty: all within the joint limits
  std::int64_t configurations = 0;   ///< drawn in the region
  double confidence = 0.95;
  std::vector<BudgetContribution> contributions;
  std::vector<ParameterContribution> parameters;  ///< largest first
  CombinedUncertainty position;                   ///< of the arm
  /// Of what one more measurement of a position deviates from the prediction
  /// by: the instrument counts as well.
  CombinedUncertainty measured;
  /// Largest combined standard uncertainty of a position's coordinate in the
  /// region, the instrument left out (m).
  double worst_std = 0.0;
};

/// The uncertainty of a calibration.
struct UncertaintyResult {
  double confidence = 0.95;
  /// Of Student's t; infinite where sigma is given.
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  /// "inverse information" or "sandwich".
  std::string estimator;
  /// Free parameters, in the order of the layout.
  std::vector<ParameterUncertainty> parameters;
  Eigen::MatrixXd covariance;  ///< of these (rad, m)
  /// What predictions take: of parameters of a model that lacks something.
  /// Empty where it is `covariance`.
  Eigen::MatrixXd prediction_covariance;
  std::vector<CorrelatedPair> correlated;
  ResidualDiagnostics residuals;
  LackOfFit lack_of_fit;
  std::optional<PredictedMap> workspace;
  std::optional<PredictionCheck> validation;
  std::optional<UncertaintyBudget> budget;
  std::vector<std::string> warnings;
};

}  // namespace alidade

#endif  // ALIDADE_UNCERTAINTY_H_
