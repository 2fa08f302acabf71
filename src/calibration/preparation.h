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

/// What a typical residual is in sigmas: the median of the norms over that of
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

/// Standard deviations that the residuals of a fit agree with.
struct EstimatedSigmas {
  double length = 0.0;    ///< median over all rows (m); 0 = none could be found
  double rotation = 0.0;  ///< the same of orientations (rad); 0 = none measured
  /// The fit uses up nearly all equations: these are what the nominal geometry
  /// leaves, more than the true ones.
  bool is_bound = false;
};

/// Changes the sigmas of training and held-out data, those of lengths and those
/// of orientations each, until the residuals of a fit agree with them:
/// chi-square equals its degrees of freedom or, with a robust loss, the median
/// of the residual norms that of their distribution. Where the stated sigmas
/// are too small, what the instrument does not explain is the model's: one
/// variance is added to all rows, so that rows of different sigmas come closer
/// in weight. Where they are too large, all are scaled. Priors weigh against
/// sigma, so that it is iterated. Lengths of 0 where a fit failed or leaves no
/// freedom.
EstimatedSigmas EstimateSigmas(CalibrationTask* task);

/// Median standard deviation of the measured lengths (m); 0 = there are none.
double MedianLengthSigma(const Dataset& data, Communicator* communicator);

/// Degrees of freedom of a fit: equations less the parameters that the data
/// rather than their priors decide,
/// p - sum_k [(J^T J + P^-1)^-1]_kk / prior_k^2 (J whitened, at `values`).
double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PREPARATION_H_
