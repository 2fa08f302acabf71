#ifndef ALIDADE_MONTE_CARLO_OPTIONS_H_
#define ALIDADE_MONTE_CARLO_OPTIONS_H_

#include <cstdint>

namespace alidade {

/// What simulated calibrations take for the real arm.
enum class SimulatedTruth {
  kGiven,       ///< the job's `truth`
  kIdentified,  ///< the job's own result: a parametric bootstrap
  kPriors,      ///< joints drawn from their priors, anew for every trial
};

/// Many simulated calibrations of the job's arm, poses and sigmas.
struct MonteCarloOptions {
  int trials = 1000;  ///< at most
  std::uint64_t seed = 1;
  SimulatedTruth truth = SimulatedTruth::kIdentified;
  /// So many of the observations are off by a Gaussian error of this size (m in
  /// every coordinate; rad of orientations divided by the reach).
  double outlier_fraction = 0.0;
  double outlier_size = 0.0;
  /// Standard deviations with which joints miss their values (rad, m).
  double joint_angle_sigma = 0.0;
  double joint_length_sigma = 0.0;
  int workspace_poses = 200;  ///< drawn within the limits, for the true error
  /// Stop where the mean error over the workspace is known to this part of
  /// itself (half of its 95 % interval); 0 = all trials.
  double precision = 0.0;
};

}  // namespace alidade

#endif  // ALIDADE_MONTE_CARLO_OPTIONS_H_
