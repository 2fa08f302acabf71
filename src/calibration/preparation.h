#ifndef ALIDADE_SRC_CALIBRATION_PREPARATION_H_
#define ALIDADE_SRC_CALIBRATION_PREPARATION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/identifiability.h"
#include "alidade/parameter_layout.h"
#include "alidade/solver.h"
#include "src/calibration/calibration_task.h"
#include "src/kernel/measurement_model.h"
#include "src/solve/solve.h"

namespace alidade::internal {

/// What is identified and solved for by one fit.
struct Fit {
  IdentifiabilityResult identifiability;
  SolverSummary summary;
  Eigen::VectorXd values;  ///< nominal where the summary is not usable

  int num_free() const { return identifiability.num_free; }
};

/// Identifies and solves by Ceres with the job's loss, over its training data.
/// `options` replace the job's own.
Fit FitOnce(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options);

/// The same where the model is known to leave far more than the sigmas say, as
/// with the joints held at nominal: the sigmas are raised to what the median
/// residual asks, so that priors have their weight, and a robust fit is
/// Huber's, since a redescending loss would give up nearly all of the data.
Fit FitPart(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options);

/// The options with priors of the joints a hundred times as wide: for a first
/// fit where the arm may be far from its nominal geometry.
IdentifiabilityOptions WidenPriors(IdentifiabilityOptions options);

/// The typical standardised residual: the median of the norms over that of
/// their distribution, for observations of any dimension. 0 for no data.
double TypicalResidual(const MeasurementModel& model, const Dataset& data,
                       const Eigen::VectorXd& values);

/// What the solvers are given of a job after its identifiability pass.
CalibrationProblem ProblemOf(const CalibrationTask& task,
                             const MeasurementModel& model,
                             const IdentifiabilityResult& pass);

/// Base, targets and references alone, the geometry of the joints held at its
/// nominal values.
IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options,
                                  const ParameterLayout& layout);

/// Base, targets, references and the zeros of the joints.
IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const MeasurementModel& model);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PREPARATION_H_
