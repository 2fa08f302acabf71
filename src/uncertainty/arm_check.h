#ifndef ALIDADE_SRC_UNCERTAINTY_ARM_CHECK_H_
#define ALIDADE_SRC_UNCERTAINTY_ARM_CHECK_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "alidade/dataset.h"
#include "src/kernel/measurement_model.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// Observations that one check takes at most: its matrices have a row for each
/// of their coordinates.
inline constexpr Eigen::Index kMostChecked = 500;

struct ArmCheckOptions {
  /// Columns of the layout that are found from the check itself: those of the
  /// base where the instrument was set up anew, of a target that was mounted
  /// anew. What changes along them is not seen.
  std::vector<int> refitted;
  /// How often an arm that is as calibrated fails.
  double significance = 0.01;
  /// With this probability a change is found that is called found.
  double power = 0.9;
};

/// Whether an arm is as it was calibrated, by a few measurements, and what
/// these can show at all. With r the residuals of m measured rows at the
/// calibrated arm and V their covariance, of measurement, of what the model
/// lacks and of what the calibration has left unknown,
///
///   T = min over a of (r - G a)^T V^-1 (r - G a)
///
/// with G the derivatives by what is refitted or was never determined. Where
/// the arm is as calibrated, T is chi-square of m - rank G degrees of freedom
/// (T over them Fisher's F where sigma was estimated). Where its rows have
/// moved by e, T is noncentral with |e|^2 in the same norm, from which follow
/// the probabilities to find a change.
struct ArmCheckResult {
  Eigen::Index num_observations = 0;
  double statistic = 0.0;           ///< T
  double degrees_of_freedom = 0.0;  ///< 0: the rows say nothing
  double limit = 0.0;               ///< of T
  double p_value = 1.0;
  double significance = 0.0;
  bool passes = true;
  double rms_error = 0.0;      ///< of positions, refitted parameters out (m)
  double max_error = 0.0;      ///< the same
  double predicted_rms = 0.0;  ///< of positions by V (m)
  /// An arm without the calibration: how far its positions are off (m), and the
  /// probability that T is above the limit.
  double uncalibrated_rms = 0.0;
  double uncalibrated_found = 0.0;
  double power = 0.0;  ///< of what follows
  /// Move of every pose's position in a direction of its own (m) that is found
  /// with that probability; infinite where none is.
  double found_move = 0.0;
  /// Change of each joint's zero (rad or m) likewise.
  Eigen::VectorXd found_zero;
  /// What would explain a failure, a sentence; empty where nothing is known.
  std::string hint;
};

/// `calibrated` has the calibrated arm as its nominal one; `uncalibrated` the
/// arm that the controller believes in, with the same base and targets.
/// O(m^3). @pre at most kMostChecked observations.
ArmCheckResult CheckArm(const MeasurementModel& calibrated,
                        const MeasurementModel& uncalibrated,
                        const ParameterCovariance& covariance,
                        const Dataset& data, const ArmCheckOptions& options);

/// P(F > f) of a noncentral F, the sum of dof1 squared normals whose squared
/// means add up to `noncentrality`, over dof1; `dof2` may be infinite.
double NoncentralFisherSurvival(double f, double dof1, double dof2,
                                double noncentrality);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_ARM_CHECK_H_
