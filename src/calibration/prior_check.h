#ifndef ALIDADE_SRC_CALIBRATION_PRIOR_CHECK_H_
#define ALIDADE_SRC_CALIBRATION_PRIOR_CHECK_H_

#include <string>

#include "src/calibration/fit_report.h"

namespace alidade::internal {

/// Whether the priors of the joints make predictions worse: a warning, or
/// nothing. Cross-validation among the training poses, repeated with other
/// folds, by least squares linearised at the solution (robust weights held),
/// with the priors and with ones a hundred times as wide: said where poses that
/// were left out have mean errors at least 2 % smaller without them, by more
/// than chance (paired t above 2, by configuration).
///
/// Asked only where the priors pull: where what they have moved the estimates
/// by could be more than a standard deviation at all, as predicted standard
/// deviations bound it, or where they dominate and sigma is estimated; and of
/// 2000 observations at most. No solve.
std::string WarnOfPriors(const CalibrationSolution& fit,
                         const IdentifiabilityResult& pass);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PRIOR_CHECK_H_
