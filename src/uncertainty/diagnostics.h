#ifndef ALIDADE_SRC_UNCERTAINTY_DIAGNOSTICS_H_
#define ALIDADE_SRC_UNCERTAINTY_DIAGNOSTICS_H_

#include <Eigen/Core>

#include "alidade/uncertainty.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// Looks whether the residuals of a fit are what its sigmas say.
///
/// With H = W J root root^T J^T W the hat matrix of the whitened rows (each
/// observation's scaled by the root w of its weight under a robust loss), and
/// H_i its block of observation i:
///
///   leverage         trace H_i, summed over the observations of a pose: how
///                    much of its own measurement a fit follows; the sum is p
///   studentised      r / sqrt(1 - h), h the row's diagonal entry
///   Cook's distance  r^T (1 - H_i)^-1 H_i (1 - H_i)^-1 r / p: how far the
///                    estimate moves without the observation, in its own
///                    covariance (Cook 1977, "Detection of influential
///                    observation in linear regression"; for blocks of rows
///                    Cook and Weisberg 1982, 3.5)
///
/// Normality of the studentised residuals, mean and variance unknown: Anderson
/// and Darling's A^2 with Stephens' correction and p-value (D'Agostino and
/// Stephens 1986, table 4.9), of at most 5000 rows evenly taken: more would
/// find what nobody needs to know. Whiteness: Ljung and Box's Q (1978) over the
/// first lags of each axis in the order of measurement, chi-square of lags
/// times axes. The p-value of chi-square itself is two-sided, for `sigma_given`
/// only. `kept`: the data without rejected observations, which chi-square
/// leaves out. O(N p^2).
ResidualDiagnostics DiagnoseResiduals(const FittedProblem& fit,
                                      const ParameterCovariance& covariance,
                                      bool sigma_given, const Dataset& kept);

/// P(A^2 >= statistic) under normality, `statistic` after Stephens' correction
/// for unknown mean and variance.
double AndersonDarlingPValue(double statistic);

/// Anderson and Darling's test of `values` against a normal of any mean and
/// variance. NaN for fewer than 8 values or for equal ones.
TestResult TestNormality(Eigen::VectorXd values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_DIAGNOSTICS_H_
