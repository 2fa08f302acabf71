#ifndef ALIDADE_SRC_SIMULATION_TRIAL_SUMS_H_
#define ALIDADE_SRC_SIMULATION_TRIAL_SUMS_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "alidade/monte_carlo.h"

namespace alidade::internal {

/// What one trial adds to all.
struct Trial {
  SimulatedTrial kept;
  Eigen::VectorXd errors;      ///< estimate - truth of the free parameters
  Eigen::VectorXd deviations;  ///< as predicted
  std::vector<char> is_held;
  std::int64_t axes_held = 0;
  std::int64_t ellipsoids_held = 0;
  /// Of the configurations whose position is predicted: how many, and the mean
  /// of their predicted variances.
  std::int64_t num_predicted = 0;
  double predicted_square = 0.0;
  double nominal_square = 0.0;  ///< mean squared error of the nominal arm
};

/// Sums over trials, from which biases, spreads and rates follow. Trials are
/// added in their order, so that the bits do not depend on threads.
class TrialSums {
 public:
  explicit TrialSums(Eigen::Index num_parameters)
      : parameters_(static_cast<std::size_t>(num_parameters)) {}

  /// One that is not usable adds nothing.
  void Add(const Trial& trial);
  std::int64_t usable() const { return usable_; }

  /// Whether the mean error in the workspace is known to `precision`, a
  /// fraction of it; 0: never.
  bool IsPreciseEnough(double precision) const;

  /// Bias, spread and coverage of a parameter. @pre a trial was usable.
  SimulatedParameter DescribeParameter(Eigen::Index k) const;
  /// Errors in the workspace and how often their predictions hold.
  /// @pre a trial was usable; the result has all trials.
  void DescribeWorkspace(MonteCarloResult* result) const;

 private:
  // Of one parameter, by Welford's recurrence.
  struct Sum {
    double mean = 0.0;
    double squares = 0.0;
    double variances = 0.0;
    std::int64_t held = 0;
  };

  std::int64_t usable_ = 0;
  std::vector<Sum> parameters_;
  std::int64_t num_predicted_ = 0;
  double nominal_square_ = 0.0;
  std::int64_t axes_held_ = 0;
  std::int64_t ellipsoids_held_ = 0;
  double predicted_square_ = 0.0;
  double rms_mean_ = 0.0;
  double rms_squares_ = 0.0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SIMULATION_TRIAL_SUMS_H_
