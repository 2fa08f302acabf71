#include "src/simulation/trial_sums.h"

#include <cmath>
#include <tuple>

#include "alidade/accuracy.h"
#include "src/common/distributions.h"

namespace alidade::internal {
namespace {

constexpr double kConfidenceOfRates = 0.95;
constexpr int kFewestTrials = 100;

Coverage MakeCoverage(std::int64_t held, std::int64_t n,
                      std::int64_t independent) {
  Coverage coverage;
  coverage.held = held;
  coverage.n = n;
  // Positions of one trial share its errors: as many independent looks as
  // there are trials.
  const double rate = coverage.rate();
  std::tie(coverage.lower, coverage.upper) =
      RateInterval(std::llround(rate * static_cast<double>(independent)),
                   independent, kConfidenceOfRates);
  return coverage;
}

}  // namespace

void TrialSums::Add(const Trial& trial) {
  if (!trial.kept.usable) return;
  ++usable_;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    Sum& sum = parameters_[i];
    const double delta = trial.errors[k] - sum.mean;
    sum.mean += delta / static_cast<double>(usable_);
    sum.squares += delta * (trial.errors[k] - sum.mean);
    sum.variances += trial.deviations[k] * trial.deviations[k];
    sum.held += trial.is_held[i];
  }
  num_predicted_ += trial.num_predicted;
  nominal_square_ += trial.nominal_square;
  axes_held_ += trial.axes_held;
  ellipsoids_held_ += trial.ellipsoids_held;
  predicted_square_ += trial.predicted_square;
  const double delta = trial.kept.workspace_rms - rms_mean_;
  rms_mean_ += delta / static_cast<double>(usable_);
  rms_squares_ += delta * (trial.kept.workspace_rms - rms_mean_);
}

bool TrialSums::IsPreciseEnough(double precision) const {
  if (precision <= 0.0 || usable_ < kFewestTrials) return false;
  const auto n = static_cast<double>(usable_);
  const double error = std::sqrt(rms_squares_ / (n - 1.0) / n);
  return NormalQuantile(0.975) * error <= precision * rms_mean_;
}

SimulatedParameter TrialSums::DescribeParameter(Eigen::Index k) const {
  const Sum& sum = parameters_[k];
  const auto n = static_cast<double>(usable_);
  SimulatedParameter parameter;
  parameter.bias = sum.mean;
  parameter.spread = usable_ > 1 ? std::sqrt(sum.squares / (n - 1.0)) : 0.0;
  parameter.bias_error = parameter.spread / std::sqrt(n);
  parameter.predicted_std = std::sqrt(sum.variances / n);
  parameter.coverage = MakeCoverage(sum.held, usable_, usable_);
  return parameter;
}

void TrialSums::DescribeWorkspace(MonteCarloResult* result) const {
  if (num_predicted_ > 0) {
    result->axes = MakeCoverage(axes_held_, 3 * num_predicted_, usable_);
    result->ellipsoids =
        MakeCoverage(ellipsoids_held_, num_predicted_, usable_);
  }
  result->workspace_before =
      std::sqrt(nominal_square_ / static_cast<double>(usable_));
  result->workspace_predicted =
      std::sqrt(predicted_square_ / static_cast<double>(usable_));
  std::vector<double> errors;
  for (const SimulatedTrial& trial : result->trials) {
    if (trial.usable) errors.push_back(trial.workspace_rms);
  }
  result->workspace = SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
      errors.data(), static_cast<Eigen::Index>(errors.size())));
}

}  // namespace alidade::internal
