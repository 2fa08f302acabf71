#ifndef ALIDADE_UNCERTAINTY_H_
#define ALIDADE_UNCERTAINTY_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "alidade/accuracy.h"

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
  /// Above this (nonlinearity.h) linear intervals no longer hold what they
  /// say: a second-order part of a fifth of the standard deviation takes
  /// about 0.5 to 1 % from a coverage of 95 %.
  double nonlinearity_limit = 0.2;
  /// Configurations that the predicted map is drawn at, within the joint
  /// limits; 0 = no map.
  int map_configurations = 2000;
  std::uint64_t seed = 1;  ///< of these
};

/// An interval that holds the true value with the stated confidence (rad, m).
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
  /// one (nonlinearity.h).
  double nonlinearity = 0.0;
  /// Part of the prior in what is known of it: 0 = the data alone, 1 = the
  /// prior alone.
  double prior_share = 0.0;
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

/// Predicted standard deviation of the target's position over the workspace
/// (root of the sum of the variances of the three axes, m).
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
  std::vector<CorrelatedPair> correlated;
  ResidualDiagnostics residuals;
  std::optional<PredictedMap> workspace;
  std::optional<PredictionCheck> validation;
  std::vector<std::string> warnings;
};

}  // namespace alidade

#endif  // ALIDADE_UNCERTAINTY_H_
