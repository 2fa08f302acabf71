#ifndef ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_
#define ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_

#include "alidade/identifiability.h"
#include "alidade/uncertainty.h"
#include "src/calibration/fit_report.h"
#include "src/calibration/outliers.h"
#include "src/uncertainty/assessment.h"

namespace alidade::internal {

/// How far a finished fit of a job can be trusted, by the job's options.
/// `pass`: what decided its free columns; `final_cost`: of the solve; the
/// outliers of the training and the validation data.
UncertaintyResult AssessFit(const CalibrationSolution& fit,
                            const IdentifiabilityResult& pass,
                            double final_cost, const OutlierSearch& training,
                            const OutlierSearch& validation);

/// Fits with one parameter held, for profiles: Ceres over the other free
/// columns of `problem`, which must outlive it.
Resolve ResolveByCeres(const CalibrationProblem& problem,
                       const SolverOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_
