#ifndef ALIDADE_SRC_UNCERTAINTY_COVARIANCE_H_
#define ALIDADE_SRC_UNCERTAINTY_COVARIANCE_H_

#include <Eigen/Core>
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "alidade/dataset.h"
#include "alidade/robust_loss.h"
#include "src/error_terms/error_fit.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// A fit that is finished: `values` minimise chi-square (or the robust cost)
/// and the priors' terms over the free columns. Holds references.
struct FittedProblem {
  const MeasurementModel& model;
  const Dataset& data;
  const std::vector<int>& free_columns;
  /// Standard deviations about nominal, one entry per column of the layout, NaN
  /// or infinite where there is none; or empty.
  const Eigen::VectorXd& priors;
  /// Of observations of 1, 2 ... rows; empty for least squares.
  const std::vector<RobustLoss>& losses;
  const Eigen::VectorXd& values;
};

/// What a prediction is off by beyond its parameters, where the model lacks
/// something (lack_of_fit.h).
struct ModelExcess {
  double length = 0.0;    ///< variance of a coordinate of the target (m^2)
  double rotation = 0.0;  ///< of a component of its rotation vector (rad^2)
  /// Standard deviation of a measured coordinate (m); 0 = not known.
  double noise = 0.0;
  /// Variance of the noise over that of the sigmas, of lengths and
  /// orientations.
  std::array<double, 2> noise_ratio = {1.0, 1.0};

  bool is_there() const { return length > 0.0 || rotation > 0.0; }
  /// Of noise and excess together, over sigma^2, in row 0 to 5 of an
  /// observation whose noise was taken as `sigma`.
  double RowVariance(Eigen::Index row, double sigma) const {
    return noise_ratio[row < 3 ? 0 : 1] +
           (row < 3 ? length : rotation) / (sigma * sigma);
  }
};

/// What is not known of parameters after a fit, to first order: estimate -
/// truth = root * u, u of the identity covariance. Where sigma is estimated, u
/// is Student's t of so many degrees of freedom rather than Gaussian.
struct ParameterCovariance {
  std::vector<int> columns;  ///< of the layout
  /// p x p: the covariance is root root^T (rad, m).
  Eigen::MatrixXd root;
  /// p x m: directions of the parameters (rad, m) along which neither data nor
  /// priors determine anything; usually m = 0.
  Eigen::MatrixXd null_space;
  /// Which parameters have a part in them, by their place in `columns`.
  std::vector<int> null_space_parameters;
  /// Huber's sandwich, not the inverse information.
  bool is_sandwich = false;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  ModelExcess excess;
  /// Where the arm has error terms that were estimated: of the parameters and
  /// these together, of which `root` is the parameters' own part.
  std::shared_ptr<const TermCovariance> terms;

  int size() const { return static_cast<int>(columns.size()); }
  /// root root^T; infinite on the diagonal and NaN beside it for parameters
  /// that have a part in what is not identifiable.
  Eigen::MatrixXd Matrix() const;
  /// Square roots of its diagonal.
  Eigen::VectorXd Deviations() const;
  bool IsTold(int index) const;
  /// Whether rows (any number x p) see nothing of what is not identifiable.
  bool AreTold(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;
};

/// The inverse of R^T R + diag(1 / prior^2): the covariance of a least-squares
/// estimate with right sigmas, and that of the posterior with right priors
/// (Lindley and Smith 1972). `whitened_factor`: R, JacobianFactor of `columns`;
/// `prior`: one entry per column, infinite where there is none.
///
/// By the triangular factor of both stacked, columns brought to unit norm; by
/// its singular values where its condition is above 1e6, those below 1e-12 of
/// the largest counting as not identifiable. O(p^3).
ParameterCovariance InverseInformation(const Eigen::MatrixXd& whitened_factor,
                                       const std::vector<int>& columns,
                                       const Eigen::VectorXd& prior);

/// The covariance of a finished fit. For least squares InverseInformation at
/// its values. For an M-estimate Huber's sandwich (Huber 1981, "Robust
/// Statistics", 7.6, with his correction of order p / n),
///
///   A^-1 B A^-1,  A = a J^T J + P^-1,  B = K^2 b J^T J + P^-1,
///   a = mean of (d w + 2 w' s) / d,  b = sum w^2 s / (equations - p),
///   K = 1 + (p / n) var(a_i) / a^2
///
/// with s the squared norm of an observation of d rows and w = rho'(s): the
/// residuals' own distribution takes the place of the Gaussian one. b estimates
/// the scale from them, so that u is Student's t of equations - p degrees of
/// freedom; where they are fewer than 5 they cannot, and it is the inverse
/// information. Means are over all observations, which is right where outliers
/// may come anywhere.
/// O(N p^2).
ParameterCovariance CovarianceOf(const FittedProblem& fit);

/// The same where error terms were estimated too.
void AddTerms(std::shared_ptr<const TermCovariance> terms,
              ParameterCovariance* covariance);

/// The priors of a fit's free columns, infinite where there is none.
Eigen::VectorXd FreePriors(const FittedProblem& fit);

/// Parameters that the data rather than their priors decide: p - sum var_k /
/// prior_k^2. Equations less this are the degrees of freedom of chi-square.
double EffectiveParameters(const ParameterCovariance& covariance,
                           const Eigen::VectorXd& prior);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_COVARIANCE_H_
