#ifndef ALIDADE_SRC_BATCH_PREPARATION_H_
#define ALIDADE_SRC_BATCH_PREPARATION_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/io/job_config.h"
#include "alidade/measurement/measurement_model.h"
#include "alidade/results/identifiability_result.h"
#include "alidade/results/solver_summary.h"
#include "alidade/solve/solver.h"

namespace alidade {

/// What is identified and solved for by one fit.
struct Fit {
  IdentifiabilityResult identifiability;
  SolverSummary summary;
  Eigen::VectorXd values;  ///< nominal where the summary is not usable

  int num_free() const { return identifiability.num_free; }
};

/// Identifies and solves by Ceres with the job's loss, over its training data.
/// `options` replace the job's own.
Fit FitOnce(const JobConfig& config, const MeasurementModel& model,
            const IdentifiabilityOptions& options);

/// Base and tool alone, the geometry of the joints held at its nominal values.
IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options);

/// Base, tool and the zeros of the joints.
IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const Arm& arm);

/// Where base or tool are to be identified, puts them where they fit the
/// training data best at the nominal geometry, from a start that needs no guess
/// of the user's (frame_start.h), so that the small rotations of the layout
/// are small: a rotation vector is a chart of SO(3) about the nominal one.
/// Nothing is done where the true arm is given, whose deviations are from the
/// arm as it stands. True: base or tool were fitted. On failure the arm is as
/// it was.
bool FitFrames(JobConfig* config, int num_threads);

/// Replaces all sigmas of training and held-out data by one that the residuals
/// of a fit with them agree with: root of chi-square over its degrees of
/// freedom, or, with a robust loss, the median of the residual norms. Priors
/// weigh against sigma, so that it is iterated. Returns it (m), or 0 where a
/// fit failed or leaves no freedom.
double EstimateSigma(JobConfig* config, int num_threads);

/// Degrees of freedom of a fit: equations less the parameters that the data
/// rather than their priors decide,
/// p - sum_k [(J^T J + P^-1)^-1]_kk / prior_k^2 (J whitened, at `values`).
double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values);

}  // namespace alidade

#endif  // ALIDADE_SRC_BATCH_PREPARATION_H_
