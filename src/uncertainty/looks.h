#ifndef ALIDADE_SRC_UNCERTAINTY_LOOKS_H_
#define ALIDADE_SRC_UNCERTAINTY_LOOKS_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/dataset.h"
#include "src/uncertainty/covariance.h"

namespace alidade::internal {

/// Rows of lengths and rows of orientations, in arrays of two.
inline constexpr int kLengths = 0;
inline constexpr int kRotations = 1;

/// A data set with what was observed more than once, at the same joint values,
/// of the same target and reference, brought to one observation, a look at the
/// arm. Of more than 5000 poses an even sample; never a part (partition.h).
struct Looks {
  Dataset data;  ///< the first observation of each look
  bool is_sample = false;
  /// Observations of each look, and the mean of their whitened residuals,
  /// stacked.
  std::vector<int> counts;
  Eigen::VectorXd residuals;
  std::vector<int> configurations;  ///< of each pose (holdout.h)
  /// Squares of whitened residuals about these means, and their degrees of
  /// freedom.
  std::array<double, 2> repeat_squares{};
  std::array<double, 2> repeat_freedom{};
};

/// Those of a finished fit. O(N log N), collective.
Looks TakeLooks(const FittedProblem& fit);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_LOOKS_H_
