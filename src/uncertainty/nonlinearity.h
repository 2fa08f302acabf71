#ifndef ALIDADE_SRC_UNCERTAINTY_NONLINEARITY_H_
#define ALIDADE_SRC_UNCERTAINTY_NONLINEARITY_H_

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "alidade/uncertainty.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// How much of what is not known of a parameter is not linear. With the root S
/// of the covariance, A = J S, the parameters values + S u and the second
/// derivatives H_ij of the whitened residuals in u, the estimate of parameter k
/// is to second order
///
///   estimate_k - truth_k = |s_k| (n^T u - 1/2 u^T Q_k u),
///   Q_k,ij = sum_m n_m (A^T H_ij)_m,  s_k the k-th row of S, n = s_k / |s_k|
///
/// and what is returned for each is the root mean square of the second term for
/// u ~ N(0, I), sqrt(|Q_k|_F^2 / 2 + tr(Q_k)^2 / 4): the first one has 1. It
/// holds the part of the curvature that lies in the tangent plane (Bates and
/// Watts 1980, "Relative curvature measures of nonlinearity": the
/// parameter-effects curvature), by parameter and in standard deviations, and
/// the bias (Box 1971, "Bias in nonlinear estimation").
///
/// By central differences of J over one standard deviation in each direction,
/// 2 p Jacobians of at most a thousand poses. Infinite for what is not
/// identifiable.
Eigen::VectorXd MeasureNonlinearity(const FittedProblem& fit,
                                    const ParameterCovariance& covariance);

/// Minimises the cost over all free parameters but the one in `fixed_column`,
/// from *values, and returns the cost (priors included), or nothing where that
/// fails.
using Resolve = std::function<std::optional<double>(int fixed_column,
                                                    Eigen::VectorXd* values)>;

/// The values v of one parameter for which the cost, minimised over all others,
/// exceeds that of the fit by no more than quantile^2:
///
///   min cost(theta_k = v) - min cost <= quantile^2,
///
/// with the quantile of a normal, or Student's t where sigma is estimated
/// (Venzon and Moolgavkar 1988, "A method for computing
/// profile-likelihood-based confidence intervals"). Unlike estimate +- quantile
/// std it is nonlinear as the model is and does not depend on how parameters
/// are chosen. The signed root of the difference is close to a straight line,
/// whose crossing is found by the secant method; a bound that is not found
/// within twenty times the linear one is infinite. About ten solves.
/// `fit_cost`: as `resolve` counts.
ConfidenceInterval ProfileInterval(const FittedProblem& fit,
                                   const ParameterCovariance& covariance,
                                   int index, double quantile, double fit_cost,
                                   const Resolve& resolve);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_NONLINEARITY_H_
