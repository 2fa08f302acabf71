#ifndef ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_
#define ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/error_terms/base_jump.h"
#include "src/error_terms/periodogram.h"
#include "src/error_terms/stacking.h"
#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_covariance.h"
#include "src/error_terms/term_normal.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// A geometric fit, and what it is to be extended by.
struct ErrorFitInput {
  const MeasurementModel& model;
  const Dataset& data;  ///< of one process
  const std::vector<int>& columns;
  const Eigen::VectorXd& values;  ///< of the geometric fit
  const Eigen::VectorXd& priors;  ///< as CalibrationProblem has them
  std::vector<RobustLoss> losses;
  std::vector<TermSet> sets;  ///< rungs beside the geometry alone
  /// Rungs are put together by their evidence within the data (stacking.h), the
  /// best of them with the harmonics that its residuals have too; else there is
  /// one, and it is taken.
  bool selects = true;
};

/// One set of terms, fitted to all data.
struct RungFit {
  TermSet set;
  TermColumns columns;
  LogPrecisions precisions = {};
  double variance = 1.0;        ///< of whitened residuals
  Eigen::VectorXd values = {};  ///< of the layout
  ErrorTerms terms = {};
  double weight = 0.0;
  double region_error = 0.0;  ///< mean over regions left out, whitened
  double random_error = 0.0;  ///< mean over random folds

  /// Prior standard deviation of a group's coefficients, in SI; 0 where there
  /// are none.
  double PriorDeviation(TermGroup group) const;
};

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
  std::shared_ptr<const TermCovariance> covariance;
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
/// of the input. Nothing where too few configurations were measured. O(N (p +
/// dense)^2 + sets folds columns^3).
std::optional<ErrorFit> FitErrorTerms(const ErrorFitInput& input);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_ERROR_FIT_H_
