#ifndef ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_
#define ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_

#include "alidade/identifiability.h"
#include "alidade/uncertainty.h"
#include "src/calibration/fit_report.h"
#include "src/calibration/outliers.h"
#include "src/uncertainty/assessment.h"

namespace alidade::internal {

/// What was found of the data beside the fit.
struct FitFindings {
  const OutlierSearch& training;
  const OutlierSearch& validation;
  const FitCovariance& covariance;
  const MeasurementKnowledge& measurement;
};

/// The covariance of a finished fit, and what its model lacks.
FitCovariance CovarianceOfFit(const CalibrationSolution& fit,
                              const NoiseKnowledge& noise);

/// The uncertainty of a finished fit, by the job's options. `pass`: what
/// decided its free columns; `final_cost`: of the solve.
UncertaintyResult AssessFit(const CalibrationSolution& fit,
                            const IdentifiabilityResult& pass,
                            double final_cost, const FitFindings& found);

/// Fits with one parameter held, for profiles: Ceres over the other free
/// columns of `problem`, which must outlive it.
Resolve ResolveByCeres(const CalibrationProblem& problem,
                       const SolverOptions& options);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FIT_UNCERTAINTY_H_
