#ifndef ALIDADE_SRC_CALIBRATION_DISTANCE_SIGMA_H_
#define ALIDADE_SRC_CALIBRATION_DISTANCE_SIGMA_H_

#include "src/calibration/calibration_task.h"
#include "src/calibration/preparation.h"

namespace alidade::internal {

/// By how much the sigmas of known distances between reference points are to be
/// multiplied. An arm whose model lacks something sees each of two points off
/// by another error, however well the distance between them is known, and
/// distances held at 0.02 mm would bend it. The factor is that under which the
/// measurements are most likely, the parameters integrated out (restricted
/// maximum likelihood, as in prior_scale.h), linearised about `fit`:
///
///   -2 log p = -k log w + log|A + w G| + w c - b^T (A + w G)^-1 b
///
/// with w = 1 / factor^2, k distances, A and g the information and the gradient
/// of everything else, priors included, G, h and c those of the distances and
/// their chi-square, b = g + w h. At most such that a distance has the sigma of
/// the difference of two measured coordinates, and 1 where the stated sigmas
/// are less likely by chance alone (log likelihood ratio of 5). O(N p^2).
double EstimateDistanceFactor(const CalibrationTask& task,
                              const MeasurementModel& model, const Fit& fit);

/// Multiplies the sigmas of known distances between reference points.
void ScaleDistanceSigmas(double factor, Dataset* data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_DISTANCE_SIGMA_H_
