#ifndef ALIDADE_SRC_UNCERTAINTY_PREDICTION_H_
#define ALIDADE_SRC_UNCERTAINTY_PREDICTION_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "alidade/uncertainty.h"
#include "src/kernel/measurement_model.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// What a calibration leaves unknown of the target's pose at one configuration,
/// to first order: J root root^T J^T, J the Jacobian of the pose, and what the
/// model lacks. Infinite where J sees a direction that is not identifiable.
struct PoseCovariance {
  Eigen::Matrix3d position;  ///< in the instrument's frame (m^2)
  Eigen::Matrix3d rotation;  ///< of the rotation vector on the left (rad^2)
};

/// Of target number `target` at each column of `joint_values` (n x N).
/// O(N p^2).
std::vector<PoseCovariance> PredictCovariances(
    const MeasurementModel& model, const Eigen::VectorXd& values,
    const ParameterCovariance& covariance, const Eigen::MatrixXd& joint_values,
    int target = 0);

/// Semi-axes of an ellipsoid of one standard deviation, descending: the roots
/// of the covariance's eigenvalues.
Eigen::Vector3d SemiAxes(const Eigen::Matrix3d& covariance);

/// The predicted standard deviation of the first target over `count`
/// configurations drawn within the joint limits (joint_draw.h). `true_values`:
/// of the real arm where it is known, else empty.
PredictedMap MapPrediction(const MeasurementModel& model,
                           const Eigen::VectorXd& values,
                           const ParameterCovariance& covariance, int count,
                           std::uint64_t seed,
                           const Eigen::VectorXd& true_values);

/// Sets predictions beside what was observed at poses that the fit has not
/// seen: every measured row r of an observation whose predicted standard
/// deviation is known, r / sqrt(1 + (J cov J^T)), in whitened units, and every
/// whole position as |L^-1 r|^2 with L L^T = I + J cov J^T. Where the model
/// lacks something, rows are first divided by the root of noise and excess
/// together. Intervals are
/// Student's t, ellipsoids Fisher's F where sigma is estimated. The verdict:
/// the share of rows within their intervals is what 95 % of all right
/// predictions come to, all rows of one sharing the error of its parameters
/// ("agree"), or they are too few ("larger") or too many. O(N p^2).
PredictionCheck CheckPrediction(const MeasurementModel& model,
                                const Eigen::VectorXd& values,
                                const ParameterCovariance& covariance,
                                const Dataset& validation, double confidence);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_PREDICTION_H_
