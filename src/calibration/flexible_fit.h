#ifndef ALIDADE_SRC_CALIBRATION_FLEXIBLE_FIT_H_
#define ALIDADE_SRC_CALIBRATION_FLEXIBLE_FIT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "alidade/calibration_result.h"
#include "src/calibration/fit_report.h"
#include "src/error_terms/error_fit.h"

namespace alidade::internal {

/// A geometric fit with the errors that are not rigid geometry.
struct FlexibleFit {
  /// Whose nominal arm has the terms.
  std::optional<MeasurementModel> model;
  Eigen::VectorXd values;
  std::shared_ptr<const TermCovariance> covariance;
};

/// Poses that the error terms are estimated from; of more, evenly chosen ones.
constexpr Eigen::Index kMostForErrorTerms = 20000;

/// Why error terms cannot be estimated from these data at all; empty where they
/// can.
std::string ErrorTermsObstacle(const CalibrationTask& task);

/// Estimates the error terms that the job's options ask for, beside the
/// geometry of `rigid`. `result` says what was tried and what it brought.
/// Nothing where the arm stays rigid.
/// Appends to `findings` what speaks against the data.
std::optional<FlexibleFit> FitFlexible(const CalibrationSolution& rigid,
                                       ErrorTermsResult* result,
                                       std::vector<Finding>* findings);

/// Where sigmas are estimated: those of all data of the task, until they agree
/// with the residuals of a fit that is better than the one they are from.
/// `effective`: coefficients that the data have decided.
void MatchSigmas(const MeasurementModel& model, const Eigen::VectorXd& values,
                 double effective, CalibrationTask* task);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_FLEXIBLE_FIT_H_
