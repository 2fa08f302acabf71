#ifndef ALIDADE_SRC_CALIBRATION_SIGMA_CHANGE_H_
#define ALIDADE_SRC_CALIBRATION_SIGMA_CHANGE_H_

#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

/// Rows of lengths, or of orientations.
enum class RowClass { kLength, kRotation };

/// The data with only the rows of one class measured, correlations left out.
Dataset RowsOfClass(const Dataset& data, RowClass which);

/// What the sigmas of a class become: scale * sqrt(sigma^2 + added^2).
struct SigmaChange {
  double scale = 1.0;
  double added = 0.0;
};

void ChangeSigmas(RowClass which, const SigmaChange& change, Dataset* data);
/// All sigmas times `factor`.
void ScaleSigmas(double factor, Dataset* data);

/// Of all measured rows of a class, of all ranks; 0 = there are none.
double MedianSigma(RowClass which, const Dataset& data,
                   Communicator* communicator);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_SIGMA_CHANGE_H_
