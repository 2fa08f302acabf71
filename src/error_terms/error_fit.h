#ifndef ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_
#define ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "src/error_terms/base_jump.h"
#include "src/error_terms/periodogram.h"
#include "src/error_terms/rung_fits.h"
#include "src/error_terms/stacking.h"
#include "src/error_terms/term_covariance.h"

namespace alidade::internal {

struct ErrorFit {
  std::vector<FoundHarmonic> harmonics;  ///< of the best rung's residuals
  /// Of the residuals that are left, where the data have no covariates.
  std::optional<BaseJump> jump;
  std::vector<RungFit> rungs;  ///< geometry alone first
  StackingResult stacking;
  Eigen::VectorXd values;
  ErrorTerms terms;
  /// What the robust losses leave each observation of `data`; 1 without one.
  Eigen::VectorXd weights;
  std::shared_ptr<const TermCovariance> covariance;  ///< null: no terms
  /// Coefficients, geometry included, that the data decide rather than their
  /// priors.
  double effective = 0.0;
};

/// Fewer configurations decide nothing.
constexpr int kFewestForErrorTerms = 10;

/// Estimates the geometry and the error terms together: for each set their
/// scales by restricted likelihood on all data, folds by regions and at random,
/// and the weights of the sets from what these leave (docs/error_terms.md). All
/// is linear about the geometric fit first and about the result then, until it
/// stays. A share of 0 where the terms have no evidence: values are then those
/// of the input, unless there are stations. Nothing where too few
/// configurations were measured. O(N (p + dense)^2 + sets folds columns^3).
std::optional<ErrorFit> FitErrorTerms(const ErrorFitInput& input);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_
