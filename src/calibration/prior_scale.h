#ifndef ALIDADE_SRC_CALIBRATION_PRIOR_SCALE_H_
#define ALIDADE_SRC_CALIBRATION_PRIOR_SCALE_H_

#include <optional>

#include "alidade/calibration_result.h"
#include "src/calibration/calibration_task.h"
#include "src/calibration/sigma_estimation.h"

namespace alidade::internal {

/// Empirical Bayes: the factors of the angles' priors and of the lengths'
/// priors of the joints under which the measurements are most likely, the
/// parameters integrated out (restricted marginal likelihood; Patterson and
/// Thompson 1971), linearised about the fit with the priors as they are,
///
///   log p = (log|P^-1| - log|J^T J + P^-1| + b^T (J^T J + P^-1)^-1 b) / 2
///
/// with P the scaled prior covariance and b = J^T (what the measurements say of
/// the deviations, whitened). Base, tool and references keep their priors. On a
/// grid of quarters of a decade from 0.03 to 300.
///
/// With a robust loss J^T J is that of the weighted observations.
///
/// Changes the priors of `task`, and its sigmas where they are estimated, twice
/// in turn: each time from those that were stated, `stated` being the task
/// before any estimate. Nothing where a fit failed.
std::optional<PriorScaling> EstimatePriors(const CalibrationTask& stated,
                                           CalibrationTask* task,
                                           EstimatedSigmas* sigmas);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PRIOR_SCALE_H_
