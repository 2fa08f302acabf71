#ifndef ALIDADE_SRC_UNCERTAINTY_ASSESSMENT_H_
#define ALIDADE_SRC_UNCERTAINTY_ASSESSMENT_H_

#include <memory>
#include <optional>
#include <string>

#include "alidade/uncertainty.h"
#include "src/uncertainty/budget.h"
#include "src/uncertainty/covariance.h"
#include "src/uncertainty/lack_of_fit.h"
#include "src/uncertainty/nonlinearity.h"

namespace alidade::internal {

/// A test of the residuals that true ones would fail this seldom (p-value) is
/// worth a word.
inline constexpr double kUnlikely = 1e-3;

/// What a fit does not know of its parameters, and what its model lacks.
struct FitCovariance {
  ParameterCovariance parameters;
  LackAssessment lack;
};

/// What is known of the noise of a fit.
struct NoiseKnowledge {
  bool sigma_estimated = false;  ///< as in AssessmentInput
  /// What of the variance of the fit is known to be the measurement's.
  StatedNoise stated = {};
  bool has_repeats = true;  ///< as in looks.h
};

/// `terms`: where error terms were estimated with the parameters; else null.
/// O(N p^2).
FitCovariance CovarianceWithLack(
    const FittedProblem& fit, const NoiseKnowledge& noise,
    std::shared_ptr<const TermCovariance> terms = nullptr);

/// What an assessment knows besides the fit.
struct AssessmentInput {
  FittedProblem fit;
  FitCovariance covariance;
  UncertaintyOptions options;
  /// Sigma was estimated from the residuals of this fit (the data's sigmas are
  /// the estimate already): intervals become Student's.
  bool sigma_estimated = false;
  /// The cost of the fit as `resolve` counts it, and how to fit with one
  /// parameter held, for profiles; linear intervals where empty.
  double fit_cost = 0.0;
  Resolve resolve = {};
  std::string no_profiles = {};  ///< why `resolve` is empty: "need ..."
  /// Validation poses; null where there are none.
  const Dataset* validation = nullptr;
  /// The data of the fit without those that it has rejected; null where there
  /// are none.
  const Dataset* kept = nullptr;
  /// Of single measurements, for the budget.
  MeasurementKnowledge measurement = {};
  /// Values of the real arm, where it is known; else empty.
  Eigen::VectorXd true_values = {};
};

/// All that is known of the uncertainty of a fit:
/// intervals (profile-likelihood ones where the model is nonlinear),
/// correlations, residual diagnostics, the predicted map, and predictions
/// against validation poses; with warnings where these speak against each
/// other. O(N p^2), and about ten solves for every profile.
UncertaintyResult AssessUncertainty(const AssessmentInput& input);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_ASSESSMENT_H_
