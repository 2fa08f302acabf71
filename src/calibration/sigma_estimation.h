#ifndef ALIDADE_SRC_CALIBRATION_SIGMA_ESTIMATION_H_
#define ALIDADE_SRC_CALIBRATION_SIGMA_ESTIMATION_H_

#include <Eigen/Core>

#include "src/calibration/calibration_task.h"
#include "src/solve/solve.h"

namespace alidade::internal {

/// Standard deviations that the residuals of a fit agree with.
struct EstimatedSigmas {
  double length = 0.0;    ///< median over all rows (m); 0 = none could be found
  double rotation = 0.0;  ///< the same of orientations (rad); 0 = none measured
  /// The fit uses up nearly all equations: these are what the nominal geometry
  /// leaves, more than the true ones.
  bool is_bound = false;
  /// Half of the data agree far better among themselves than with the others,
  /// which the loss does not leave out.
  bool has_two_groups = false;
  /// By which the sigmas of known distances between reference points were
  /// multiplied (distance_sigma.h).
  double distance_factor = 1.0;
};

/// Changes the sigmas of training and validation data, those of lengths and
/// those of orientations each, until the residuals of a fit agree with them:
/// chi-square equals its degrees of freedom or, with a robust loss, the median
/// of the residual norms that of their distribution. Where the stated sigmas
/// are too small, what the instrument does not explain is the model's: one
/// variance is added to all rows, so that rows of different sigmas come closer
/// in weight. Where they are too large, all are scaled. Priors weigh against
/// sigma, so that it is iterated. The posterior of values and sigmas may have
/// several maxima: the rounds are begun with wide priors too and, with a robust
/// loss, from the half of the data that agree best, and the best is taken.
/// Sigmas of known distances between reference points are no measurement's and
/// stay, unless the others contradict them (distance_sigma.h).
/// Lengths of 0 where a fit failed or leaves no freedom.
EstimatedSigmas EstimateSigmas(CalibrationTask* task);

/// Median standard deviation of the measured lengths (m); 0 = there are none.
double MedianLengthSigma(const Dataset& data, Communicator* communicator);

/// Degrees of freedom of a fit: equations less the parameters that the data
/// rather than their priors decide,
/// p - sum_k [(J^T J + P^-1)^-1]_kk / prior_k^2 (J whitened, at `values`).
double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values);
/// The same of some of the problem's data alone: their equations less what they
/// decide.
double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values, const Dataset& part);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_SIGMA_ESTIMATION_H_
