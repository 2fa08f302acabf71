#ifndef ALIDADE_MEASUREMENT_POSITION_MODEL_H_
#define ALIDADE_MEASUREMENT_POSITION_MODEL_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/measurement/dataset.h"
#include "alidade/model/arm.h"
#include "alidade/model/parameter_layout.h"

namespace alidade {

/// Whitened residuals and their derivatives, pose by pose, x y z within a pose:
///
///   residuals = (p_predicted - p_measured) / sigma        (3 N)
///   jacobian  = d residuals / d parameters                (3 N x columns)
///
/// The sum of squared residuals is chi-square.
struct Linearization {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

/// An arm whose parameters vary, and the positions it predicts: the one place
/// where residuals and Jacobians of positions come from (the autodiff residual
/// of one pose, position_cost.h, shares its forward kinematics and is tested
/// against it).
///
/// `values` have one entry per column of the layout. Results do not depend on
/// the number of threads. Const methods may be called from several threads.
class PositionModel {
 public:
  /// @pre nominal has a joint; num_threads >= 1.
  explicit PositionModel(Arm nominal, int num_threads = 1);

  const Arm& nominal() const { return nominal_; }
  const ParameterLayout& layout() const { return layout_; }
  int num_threads() const { return num_threads_; }

  /// Values of the nominal arm.
  Eigen::VectorXd NominalValues() const { return layout_.Values(nominal_); }

  /// Predicted positions (3 x N, m) at joint values (n x N).
  Eigen::Matrix3Xd Predict(const Eigen::VectorXd& values,
                           const Eigen::MatrixXd& joint_values) const;

  /// Predicted minus measured positions (3 x N, m), not whitened.
  Eigen::Matrix3Xd Errors(const Eigen::VectorXd& values,
                          const Dataset& data) const;

  /// Residuals, and the Jacobian's columns `columns` in that order, by the
  /// geometric formulas of chain_axes.h. O(N n) time.
  void Linearize(const Eigen::VectorXd& values, const Dataset& data,
                 const std::vector<int>& columns, Linearization* out) const;

  /// The size of a predicted coordinate's rounding error (m): the unit in the
  /// last place of the arm's reach. Single coordinates may be off by twice it.
  double RoundingError() const;

 private:
  Arm nominal_;
  ParameterLayout layout_;
  int num_threads_;
};

/// Squared norm of each whitened position error, one entry per observation.
Eigen::VectorXd SquaredNorms(const Eigen::Matrix3Xd& errors,
                             const Dataset& data);

/// Chi-square of position errors: sum of (error / sigma)^2.
double ChiSquare(const Eigen::Matrix3Xd& errors, const Dataset& data);

}  // namespace alidade

#endif  // ALIDADE_MEASUREMENT_POSITION_MODEL_H_
