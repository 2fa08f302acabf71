#ifndef ALIDADE_SRC_UNCERTAINTY_LACK_OF_FIT_H_
#define ALIDADE_SRC_UNCERTAINTY_LACK_OF_FIT_H_

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "alidade/uncertainty.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// Repeats of fewer degrees of freedom do not determine the noise.
inline constexpr double kFewestRepeats = 10.0;

/// Of a reduced chi-square: residuals so far below their sigmas are those of
/// data without noise, of which no test says anything.
inline constexpr double kMuchSmaller = 0.1;

/// Variance of the measurement alone over that which the fit took, of lengths
/// and of orientations; nothing where nobody states it.
using StatedNoise = std::optional<std::array<double, 2>>;

/// What a fit says of the model's own errors.
struct LackAssessment {
  LackOfFit lack;
  /// `covariance` of the fit, with what the model lacks: for predictions.
  ParameterCovariance prediction;
  bool differs = false;        ///< ... and it is another one
  Eigen::VectorXd robust_std;  ///< of the free parameters
  std::vector<std::string> warnings;
};

/// Compares the residuals with the measurement's noise, known by repeats (of
/// at least 10 degrees of freedom), else as stated, else as what is left where
/// the structure that was found is taken out. Over looks (looks.h), with v the
/// mean square of their residuals over its degrees of freedom and v_n that of
/// the noise of a mean of repeats,
///
///   F = v / v_n    (one-sided; Draper and Smith 1998, "Applied Regression
///                  Analysis", 2.1, where the noise is that of repeats)
///   s^2 = (v - v_n) / mean(1 / sigma^2)    the excess variance of a coordinate
///
/// s^2 is zero where p > 0.05. It is taken as one error of each configuration,
/// independent of others: positions are off by s in each axis beyond what their
/// parameters leave, and the covariance of these becomes C F C with
///
///   F = v_n J^T J + s^2 sum_looks (sum_repeats J^T / sigma)(...)^T + P^-1
///
/// Robust standard deviations are those of C (sum_configurations g g^T + P^-1)
/// C, g = J^T r of all that was observed at a configuration (Liang and Zeger
/// 1986). Where there are enough configurations for blocks of neighbours
/// (looks.h), what g of the blocks adds to the variances is added to them. O(N
/// (p + m)^2), m structure columns, N at most 5000. Collective. `has_repeats`:
/// as in looks.h.
LackAssessment AssessLackOfFit(const FittedProblem& fit,
                               const ParameterCovariance& covariance,
                               const StatedNoise& stated,
                               bool has_repeats = true);

/// "the gravity moment of joint 2": what residuals of this structure follow.
std::string NameOf(const StructureTest& test);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_LACK_OF_FIT_H_
