#ifndef ALIDADE_MONTE_CARLO_RESULT_H_
#define ALIDADE_MONTE_CARLO_RESULT_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/uncertainty_result.h"
#include "alidade/units.h"

namespace alidade {

/// One free parameter over many simulated calibrations (rad, m).
struct SimulatedParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  /// NaN where every trial has a truth of its own.
  double truth = std::numeric_limits<double>::quiet_NaN();
  double bias = 0.0;        ///< mean of estimate - truth
  double bias_error = 0.0;  ///< standard error of it
  double spread = 0.0;      ///< standard deviation of estimate - truth
  /// Root mean square of the standard deviations that the trials told.
  double predicted_std = 0.0;
  /// The least that an unbiased estimate can have (Cramer and Rao), from the
  /// sigmas and priors, without outliers.
  double bound = 0.0;
  Coverage coverage;        ///< of the truth by the trials' intervals
  bool is_profile = false;  ///< intervals of the profile likelihood
};

/// One simulated calibration.
struct SimulatedTrial {
  bool usable = false;
  double reduced_chi_square = 0.0;
  /// Root mean square over the workspace of the true error (m).
  double workspace_rms = 0.0;
  Eigen::VectorXd estimates;  ///< of the free parameters
};

struct MonteCarloResult {
  std::string title;
  std::string truth;  ///< "given", "identified" or "priors"
  std::uint64_t seed = 0;
  int trials_wanted = 0;
  int failed = 0;  ///< of the trials; left out of all below
  /// Ended before trials_wanted, since the precision was reached.
  bool stopped_early = false;
  double confidence = 0.95;
  bool sigma_estimated = false;
  std::vector<SimulatedTrial> trials;
  std::vector<SimulatedParameter> parameters;
  Coverage axes;        ///< of true coordinates over the workspace
  Coverage ellipsoids;  ///< of true positions
  int workspace_poses = 0;
  double workspace_before = 0.0;     ///< rms error of the nominal arm (m)
  double workspace_predicted = 0.0;  ///< root mean square of predictions (m)
  Accuracy workspace;                ///< of the trials' rms errors
  /// Root mean square over the parameters of spread / bound.
  double inefficiency = 0.0;
  double time_s = 0.0;
};

}  // namespace alidade

#endif  // ALIDADE_MONTE_CARLO_RESULT_H_
