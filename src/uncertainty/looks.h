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
/// arm. Of more than 5000 poses an even sample, of whole configurations where
/// there are repeats; never a part (partition.h).
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

/// Configurations in blocks of neighbours in joint space, the same number in
/// each but for one, by cuts at medians: the block of each configuration.
/// Between 2 and 4 times as many blocks as `parameters`; nothing where a block
/// would have fewer than four configurations.
std::vector<int> BlocksOfNeighbours(const Looks& looks, int parameters);

/// Those of a finished fit. `has_repeats`: whether any configuration was
/// measured more than once. O(N log N), collective.
Looks TakeLooks(const FittedProblem& fit, bool has_repeats = true);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_LOOKS_H_
