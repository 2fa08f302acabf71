#ifndef ALIDADE_SRC_CALIBRATION_FIT_REPORT_H_
#define ALIDADE_SRC_CALIBRATION_FIT_REPORT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/calibration/calibration_task.h"
#include "src/error_terms/error_fit.h"
#include "src/kernel/measurement_model.h"
#include "src/solve/solve.h"

namespace alidade::internal {

/// A finished fit, for what is reported of it.
struct CalibrationSolution {
  const CalibrationTask& task;
  const CalibrationProblem& problem;
  const Eigen::VectorXd& values;
  /// Where error terms were estimated too; else null.
  std::shared_ptr<const TermCovariance> terms = nullptr;

  const MeasurementModel& model() const { return problem.model; }
};

/// What each part of a calibration brings: frames only (the nominal values of
/// the model), joint offsets, all geometry.
std::vector<StageResult> ListStages(const CalibrationSolution& fit,
                                    int num_free);

/// Chi-square of the training data, or of a part of their observations, over
/// its degrees of freedom, priors accounted for; 0 where fewer than one is
/// left.
double ReducedChiSquare(const CalibrationSolution& fit, const Dataset& data);

/// Free parameters further from nominal than their priors allow, as
/// "d3 (6.1), ...", in standard deviations; empty where there are none.
std::string FarFromPriors(const CalibrationSolution& fit);

/// Free parameters at one of their bounds, by name.
std::string AtBounds(const CalibrationSolution& fit);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FIT_REPORT_H_
