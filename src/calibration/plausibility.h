#ifndef ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_
#define ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_

#include <optional>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "alidade/communicator.h"
#include "alidade/dataset.h"
#include "alidade/identifiability.h"
#include "src/calibration/mistake_search.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// What speaks against the data before anything is calibrated:
///
///   - a few positions at a distance from the others that no arm of this size
///     reaches;
///   - positions that do not move while the joints do;
///   - positions that fit the nominal arm with no base and tool to within 2 %
///     of its reach (median), or to within a fifth of how far they lie apart,
///     and that a calibration of all parameters does not explain either.
///
/// Mistakes that people make (input_mistakes.h), one or two together, are then
/// tried on the data: a cure counts where an arm that is calibrated with two
/// thirds of the mended positions predicts the others to 0.1 % of the reach and
/// 2 % of how far they lie apart, four times better than without it. Where
/// several do so alike, because base and tool can imitate one by another, the
/// sentence names all of them. Poses are tried as their inverses too, and,
/// where nothing of this explains the data, rows up to one and from there on as
/// those of two stations. Nothing is said where fewer than twelve positions of
/// the first target were measured. Looks at 60 positions; takes milliseconds
/// where they fit, and about a second where they do not.
///
/// Cures are found with base and tool free. Those that explain the data with
/// what `candidates` leave known are preferred; where none does, that is said.
/// `held_out`: rows that were between those of `data`, or null.
InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             const CandidateGroups& candidates,
                             Communicator* communicator = SingleProcess(),
                             const Dataset* held_out = nullptr);

/// Positions whose three coordinates are the same number (0, -9999), as
/// instruments write for a lost target, if any: the finding's statistic is
/// their number. Collective (kernel/partition.h).
std::optional<Finding> DiagnoseLost(
    const Dataset& data, Communicator* communicator = SingleProcess());

/// Positions that are, to the bit, the one measured before although the arm,
/// whose `values` these are, had moved by more than 10 standard deviations in
/// between: the instrument had not measured anew. Nothing of a part.
std::optional<Finding> DiagnoseStale(const MeasurementModel& model,
                                     const Eigen::VectorXd& values,
                                     const Dataset& data);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_
