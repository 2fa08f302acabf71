#ifndef ALIDADE_MONTE_CARLO_H_
#define ALIDADE_MONTE_CARLO_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "alidade/accuracy.h"
#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/uncertainty.h"
#include "alidade/units.h"

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

/// One free parameter over many simulated calibrations (rad, m).
struct SimulatedParameter {
  std::string name;
  Dimension dimension = Dimension::kLength;
  /// NaN where every trial has a truth of its own.
  double truth = std::numeric_limits<double>::quiet_NaN();
  double bias = 0.0;        ///< mean of estimate - truth
  double bias_error = 0.0;  ///< standard error of it
  double spread = 0.0;      ///< standard deviation of estimate - truth
  /// Root mean square of the standard deviations that the trials predicted.
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

/// Called with the trials done and those wanted, from one thread.
using TrialProgress = std::function<void(int done, int wanted)>;

/// Calibrates simulated measurements of the job's poses again and again, as
/// the options says, and sets what the calibrations say of themselves
/// beside the truth: bias and spread of every free parameter, how often its
/// interval holds it, how often true positions over the workspace lie within
/// their intervals and ellipsoids, and how far off the arm is there.
///
/// Trial k draws from stream k of the seed, so that it is the same in whatever
/// thread it runs and however many trials there are. The identifiability pass
/// is made once: it depends on poses and sigmas alone.
///
/// The truth of a free parameter that identifies a combination with fixed ones
/// which are not at their nominal values is what exact measurements would give
/// it.
///
/// @throws InputError where the data hold contacts, which cannot be simulated
/// at given joint values, or where the job itself, whose result is to be the
/// truth, finds none.
MonteCarloResult RunMonteCarlo(const Arm& arm, const CalibrationData& data,
                               const CalibrationOptions& options,
                               const MonteCarloOptions& study = {},
                               const TrialProgress& progress = {});

}  // namespace alidade

#endif  // ALIDADE_MONTE_CARLO_H_
