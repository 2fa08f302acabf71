#ifndef ALIDADE_SRC_CALIBRATION_TRIMMED_FIT_H_
#define ALIDADE_SRC_CALIBRATION_TRIMMED_FIT_H_

#include <Eigen/Core>
#include <optional>

#include "src/solve/solve.h"

namespace alidade::internal {

/// A fit to that half of the observations which agree best.
struct TrimmedFit {
  Eigen::VectorXd values;
  /// What a typical residual is in sigmas (TypicalResidual), over that of the
  /// fit that it began with.
  double scale = 1.0;
};

/// Least trimmed squares of the problem linearised at `values`, by
/// concentration from random subsets (Rousseeuw and Van Driessen 2006,
/// "Computing LTS regression for large data sets"): an M-estimate whose scale
/// comes from all residuals settles between two groups of observations where
/// nearly half of them are off together, and calls all of them ordinary; this
/// settles on the larger group. Linear is enough: the groups are millimetres
/// apart, at which second-order effects are micrometres.
///
/// Looks at 120 observations at most, so that it costs the same however many
/// there are, some 50 ms; the same on all ranks. Nothing where a half of them
/// would be fewer than two equations a parameter: it would agree with anything.
std::optional<TrimmedFit> FitTrimmed(const CalibrationProblem& problem,
                                     const Eigen::VectorXd& values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_TRIMMED_FIT_H_
