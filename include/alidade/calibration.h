#ifndef ALIDADE_CALIBRATION_H_
#define ALIDADE_CALIBRATION_H_

#include "alidade/arm.h"
#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"

namespace alidade {

/// Calibrates an arm: finds base, targets and references that are to be
/// identified, estimates the measurement's standard deviation where asked,
/// decides which parameters these poses determine, solves
///
///   min  sum_i rho(|(predicted_i - measured_i) / sigma_i|^2) + priors
///
/// by Levenberg-Marquardt over the free ones, and evaluates the solution:
/// uncertainty, accuracy at training and validation poses before and after,
/// accuracy by stage, outliers, acceptance limits, warnings.
///
/// \code
///   CalibrationOptions options;
///   options.identifiability.candidates.base = true;
///   options.identifiability.candidates.tool = true;
///   CalibrationResult result = Calibrate(arm, data, options);
///   if (!result.IsUsable()) return Fail(result.FullReport());
///   double length = result.Parameter("d3").value;  // +- result...std
/// \endcode
///
/// A pure function of its arguments: it reads and writes no file, and the same
/// arguments give the same bits on one machine, whatever the number of threads.
/// Costs one identifiability analysis, O(N p^2) with a factor for its generic
/// poses, and some ten reductions of the N observations to p rows (docs/
/// benchmarks.md). Safe to call from several threads.
///
/// Numerical trouble is a status of the result, not an exception.
/// @throws InputError where the options are not valid, the data do not go with
/// the arm, or the measured positions fit the nominal arm nowhere and one input
/// mistake explains it (units, columns, signs), which the message names.
CalibrationResult Calibrate(const Arm& arm, const CalibrationData& data,
                            const CalibrationOptions& options = {});

/// The identifiability analysis of Calibrate alone: which parameters these
/// poses determine, and why not the others. @throws InputError as Calibrate.
IdentifiabilityResult AnalyzeIdentifiability(
    const Arm& arm, const CalibrationData& data,
    const CalibrationOptions& options = {});

}  // namespace alidade

#endif  // ALIDADE_CALIBRATION_H_
