#ifndef ALIDADE_SRC_ERROR_TERMS_STACKING_H_
#define ALIDADE_SRC_ERROR_TERMS_STACKING_H_

#include <Eigen/Core>
#include <vector>

namespace alidade::internal {

/// What every rung leaves of the observations of one fold that it was fitted
/// without: one matrix per observation, lengths x rungs (whitened), the first
/// rung geometry alone.
struct FoldErrors {
  std::vector<Eigen::MatrixXd> residuals;
  std::vector<int> poses;  ///< of each
  bool is_region = false;
};

/// How rungs are put together.
struct StackingResult {
  /// Of each rung, none negative, of sum 1.
  Eigen::VectorXd weights;
  /// How much of the step from geometry alone to the stack is taken, 0 to 1.
  double share = 0.0;
  double t_regions = 0.0;  ///< evidence that it gains
  double t_random = 0.0;
  /// Mean error of what is delivered so, with weights found without each fold.
  double region_error = 0.0;
  double random_error = 0.0;
};

/// Weights of least squared residual over all folds, each observation weighted
/// by min(1, median / its smallest residual over the rungs) (Wolpert 1992,
/// "Stacked generalization"; Breiman 1996, "Stacked regressions"), and how far
/// they are trusted: 1 - (2 / t)^3, not below 0, with t the smaller of
///
///   t of log(mean error of geometry / of the stack) over regions,
///   paired t of both over the poses of random folds, differences clipped at
///   four times their median size,
///
/// where each fold is predicted with weights that were found without it. @pre
/// there are folds, none of them empty.
StackingResult Stack(const std::vector<FoldErrors>& folds);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_STACKING_H_
