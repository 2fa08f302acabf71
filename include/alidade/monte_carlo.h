#ifndef ALIDADE_MONTE_CARLO_H_
#define ALIDADE_MONTE_CARLO_H_

#include <functional>

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/monte_carlo_options.h"
#include "alidade/monte_carlo_result.h"

namespace alidade {

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
/// The truth of a free parameter that stands for frozen ones which are not at
/// their nominal values is what exact measurements would give it.
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
