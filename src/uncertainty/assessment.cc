#include "src/uncertainty/assessment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "src/common/distributions.h"
#include "src/kernel/partition.h"
#include "src/uncertainty/diagnostics.h"
#include "src/uncertainty/prediction.h"

namespace alidade::internal {
namespace {

// Beyond this two parameters can only be determined together.
constexpr double kStrongCorrelation = 0.9;
constexpr std::size_t kMostPairs = 20;
// Validation errors that are larger by less are a note: of 60 poses one in
// twenty calibrations has such.
constexpr double kWorthAWarning = 1.25;

class Assessment {
 public:
  explicit Assessment(const AssessmentInput& input)
      : input_(input),
        fit_(input.fit),
        covariance_(input.covariance.parameters),
        prediction_(input.covariance.lack.prediction),
        prior_(FreePriors(input.fit)) {}

  UncertaintyResult Run() {
    result_.confidence = input_.options.confidence;
    result_.estimator =
        covariance_.is_sandwich ? "sandwich" : "inverse information";
    if (!fit_.losses.empty() && !covariance_.is_sandwich) {
      result_.warnings.emplace_back(
          "too few observations to determine the scale of what a robust loss "
          "leaves: "
          "standard deviations are those of least squares");
    }
    result_.degrees_of_freedom = covariance_.degrees_of_freedom;
    result_.covariance = covariance_.Matrix();
    const LackAssessment& lack = input_.covariance.lack;
    result_.lack_of_fit = lack.lack;
    if (lack.differs) result_.prediction_covariance = prediction_.Matrix();
    ListParameters();
    ListPairs();
    result_.residuals =
        DiagnoseResiduals(fit_, covariance_, !input_.sigma_estimated,
                          input_.kept != nullptr ? *input_.kept : fit_.data);
    Predict();
    WarnOfResiduals(lack.warnings.empty());
    result_.warnings.insert(result_.warnings.end(), lack.warnings.begin(),
                            lack.warnings.end());
    return std::move(result_);
  }

 private:
  const std::string& NameOf(int index) const {
    return fit_.model.layout().parameter(covariance_.columns[index]).name;
  }

  bool WantsProfile(double nonlinearity) const {
    if (!input_.resolve) return false;
    switch (input_.options.intervals) {
      case IntervalMethod::kLinear:
        return false;
      case IntervalMethod::kProfile:
        return true;
      case IntervalMethod::kAutomatic:
        return nonlinearity > input_.options.nonlinearity_limit;
    }
    return false;
  }

  void ListParameters() {
    const Eigen::VectorXd deviations = covariance_.Deviations();
    const Eigen::VectorXd nonlinearity = MeasureNonlinearity(fit_, covariance_);
    const double quantile = StudentTQuantile(0.5 + 0.5 * result_.confidence,
                                             covariance_.degrees_of_freedom);
    std::string bent;
    for (int k = 0; k < covariance_.size(); ++k) {
      ParameterUncertainty one;
      one.name = NameOf(k);
      one.std = deviations[k];
      one.robust_std = input_.covariance.lack.robust_std[k];
      one.nonlinearity = nonlinearity[k];
      if (std::isfinite(prior_[k])) {
        const double share = one.std / prior_[k];
        one.prior_share = std::min(1.0, share * share);
      }
      const double value = fit_.values[covariance_.columns[k]];
      one.interval.lower = value - quantile * one.std;
      one.interval.upper = value + quantile * one.std;
      if (one.nonlinearity > input_.options.nonlinearity_limit) {
        bent += (bent.empty() ? "" : ", ") + one.name;
      }
      if (WantsProfile(one.nonlinearity)) {
        one.interval = ProfileInterval(fit_, covariance_, k, quantile,
                                       input_.fit_cost, input_.resolve);
      }
      result_.parameters.push_back(std::move(one));
    }
    if (!bent.empty()) WarnOfBending(bent);
  }

  void WarnOfBending(const std::string& names) {
    std::string intervals =
        "linear intervals there hold less often than they say; ";
    if (!input_.resolve) {
      intervals += "measure more poses to narrow it";
      if (!input_.no_profiles.empty()) {
        intervals += " (profiles " + input_.no_profiles + ")";
      }
    } else if (input_.options.intervals == IntervalMethod::kLinear) {
      intervals += "leave out `uncertainty: {intervals: linear}`";
    } else {
      intervals =
          "intervals there are those of the profile likelihood, and standard "
          "deviations alone say too little";
    }
    result_.warnings.push_back(
        "the model is nonlinear within the uncertainty "
        "of " +
        names + ": " + intervals);
  }

  void ListPairs() {
    const Eigen::MatrixXd& covariance = result_.covariance;
    for (int a = 0; a < covariance_.size(); ++a) {
      for (int b = a + 1; b < covariance_.size(); ++b) {
        const double correlation =
            covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
        if (!(std::abs(correlation) >= kStrongCorrelation)) continue;
        result_.correlated.push_back({NameOf(a), NameOf(b), correlation});
      }
    }
    std::stable_sort(result_.correlated.begin(), result_.correlated.end(),
                     [](const CorrelatedPair& a, const CorrelatedPair& b) {
                       return std::abs(a.correlation) > std::abs(b.correlation);
                     });
    if (result_.correlated.size() > kMostPairs) {
      result_.correlated.resize(kMostPairs);
    }
  }

  void Predict() {
    if (input_.options.map_configurations > 0) {
      result_.workspace =
          MapPrediction(fit_.model, fit_.values, prediction_,
                        input_.options.map_configurations, input_.options.seed,
                        input_.true_values);
    }
    if (input_.options.region_configurations > 0) {
      result_.budget =
          MakeBudget({fit_.model, fit_.values, prediction_, result_.lack_of_fit,
                      input_.measurement, input_.options});
      if (!result_.budget) {
        result_.warnings.emplace_back(
            "there is no uncertainty budget: of the configurations that were "
            "drawn within the joint limits, none has the target in a box of "
            "`uncertainty: {region: ...}`. They are in the base's frame; a box "
            "that is reached may be too small to be found so");
      }
    }
    if (input_.validation == nullptr) return;
    result_.validation =
        CheckPrediction(fit_.model, fit_.values, prediction_,
                        *input_.validation, result_.confidence);
    if (result_.validation->verdict == "larger" &&
        result_.validation->rms_z > kWorthAWarning) {
      result_.warnings.emplace_back(
          "validation errors are larger than predicted: sigma is stated too "
          "small, or the arm has errors that its parameters do not describe");
    }
  }

  // Where sigma is stated, and chi-square excludes it. (From four times on the
  // job itself warns, and far below there is no noise.)
  void WarnOfSigma() {
    const ResidualDiagnostics& residuals = result_.residuals;
    const double factor = std::sqrt(residuals.reduced_chi_square);
    constexpr double kMost = 4.0;
    constexpr double kLeast = 0.1;
    if (input_.sigma_estimated || !fit_.losses.empty() || factor > kMost ||
        factor < kLeast || !(residuals.chi_square_p_value < kUnlikely)) {
      return;
    }
    std::ostringstream text;
    text.precision(3);
    text << "the residuals are " << factor
         << " times as large as the stated sigmas, by more than chance: "
         << "intervals are too " << (factor > 1.0 ? "narrow" : "wide")
         << " by that; state sigma better, or `measurement: {sigma: estimate}`";
    result_.warnings.push_back(text.str());
  }

  void WarnOfResiduals(bool lacks_nothing) {
    if (lacks_nothing) WarnOfSigma();
    const ResidualDiagnostics& residuals = result_.residuals;
    if (residuals.reduced_chi_square < kMuchSmaller) return;
    if (residuals.normality.p_value < kUnlikely && fit_.losses.empty()) {
      result_.warnings.emplace_back(
          "the residuals are not Gaussian: look for outliers (with the line "
          "`robust: {loss: huber}` in the job) and for errors that the "
          "parameters do not describe");
    }
    if (residuals.whiteness.p_value < kUnlikely) {
      result_.warnings.emplace_back(
          "residuals of consecutive poses resemble each other: something "
          "drifts (temperature, instrument), or the poses are in an order "
          "along which the model is nonlinear; intervals are then too narrow");
    }
  }

  const AssessmentInput& input_;
  const FittedProblem& fit_;
  const ParameterCovariance& covariance_;
  const ParameterCovariance& prediction_;  // with what the model lacks
  const Eigen::VectorXd prior_;
  UncertaintyResult result_;
};

}  // namespace

FitCovariance CovarianceWithLack(const FittedProblem& fit,
                                 const NoiseKnowledge& noise,
                                 std::shared_ptr<const TermCovariance> terms) {
  FitCovariance found{CovarianceOf(fit), {}};
  if (terms) AddTerms(std::move(terms), &found.parameters);
  if (noise.sigma_estimated) {
    found.parameters.degrees_of_freedom = std::max(
        1.0, static_cast<double>(
                 GlobalEquations(fit.model.communicator(), fit.data)) -
                 EffectiveParameters(found.parameters, FreePriors(fit)));
  }
  found.lack =
      AssessLackOfFit(fit, found.parameters, noise.stated, noise.has_repeats);
  return found;
}

UncertaintyResult AssessUncertainty(const AssessmentInput& input) {
  return Assessment(input).Run();
}

}  // namespace alidade::internal
