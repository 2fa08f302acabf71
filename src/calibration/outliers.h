#ifndef ALIDADE_SRC_CALIBRATION_OUTLIERS_H_
#define ALIDADE_SRC_CALIBRATION_OUTLIERS_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/calibration/fit_report.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// The observations of a data set that are farther off than one of all would be
/// by chance in 5 % of calibrations. Where the loss is robust, those of less
/// than half weight are rejected: errors are then stated with and without them.
struct OutlierSearch {
  std::vector<Outlier> outliers;  ///< worst first; of all ranks, on the root
  /// How far that is, in sigmas, for an observation of three rows; those of
  /// other dimensions have limits of the same probability.
  double limit = 0.0;
  std::int64_t num_outliers = 0;  ///< of all ranks, as the next
  std::int64_t num_rejected = 0;
  /// The data with rejected observations as if they had not been measured;
  /// nothing where there are none.
  std::optional<Dataset> kept;
  /// The same without any outlier, of validation data only: what predictions
  /// are compared with.
  std::optional<Dataset> ordinary;
};

/// The observations of a list that are rejected, in ascending order.
std::vector<Eigen::Index> RejectedObservations(
    const std::vector<Outlier>& outliers);

/// Where those of a list were measured, the first three of them, of the
/// rejected ones alone if there are any: " (file.csv:7, file.csv:9 and 3
/// more)"; empty where that is not known.
std::string PlacesOf(const std::vector<Outlier>& outliers);

/// Of the training data, by the norm of the whitened residual.
OutlierSearch FindOutliers(const CalibrationSolution& fit);

/// Of the validation data, by the norm of the residual in its predicted
/// standard deviations, by `prediction`: those of the parameters and of what
/// the model lacks included. So many that mistakes
/// of measurement do not explain them (more than a fifth, and more than twice
/// the part of the training data) are listed, but neither rejected nor left
/// out: the fit does not describe these poses. Costs one evaluation of the
/// residuals, and one of their derivatives where any is beyond the limit of a
/// fit that is known exactly. @pre fit.task.data.validation.
OutlierSearch FindValidationOutliers(const CalibrationSolution& fit,
                                     const OutlierSearch& training,
                                     const ParameterCovariance& prediction);

/// The errors of every iteration of a run anew, of the observations that were
/// kept: the figure of the convergence is of those that the result is judged
/// by. As many evaluations of the residuals as iterations.
void CountKeptAlone(const CalibrationSolution& fit,
                    const OutlierSearch& training, SolverSummary* summary);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_OUTLIERS_H_
