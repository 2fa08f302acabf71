#ifndef ALIDADE_SRC_IDENTIFIABILITY_RULES_H_
#define ALIDADE_SRC_IDENTIFIABILITY_RULES_H_

#include <vector>

#include "alidade/identifiability.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {

/// The identifiability pass of the published study: which joint parameters a
/// calibration can find from these poses, by three rules that are read off the
/// nominal model,
///
///   1. beta_j is fixed unless axis j is parallel to axis j - 1
///      (sin alpha_j = 0): Hayati's beta is needed there only;
///   2. a parameter whose Jacobian column is zero over the poses is fixed: no
///      measurement moves with it;
///   3. of the r of a run of parallel axes (sin alpha_j = sin beta_j = 0) only
///      the first is kept: they move the target along the same direction, so
///      its identified combination is their (signed) sum;
///
/// and then what `options.fix` names. Base and tool are given, not identified.
///
/// The rules look at single columns, so they may keep parameters that no
/// measurement distinguishes. The pass therefore compares the number kept with
/// two ranks of the scaled Jacobian over these poses: at slightly perturbed
/// geometries, beyond which no solver can go (exceeds_rank: a solve must be
/// refused unless the user proceeds or fixes more), and at the nominal
/// geometry, below which parameters are distinguished only by second-order
/// effects
/// (`weak`, and a warning).
///
/// Nothing is solved. Cost: a few Jacobians and their factors.
/// @pre options.IsValid(), names in `fix` exist, data has a pose and the
/// model's joint count.
IdentifiabilityResult ApplyRules(const MeasurementModel& model,
                                 const Dataset& data,
                                 const IdentifiabilityOptions& options);

/// Columns of the free parameters, ascending.
std::vector<int> FreeColumns(const IdentifiabilityResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_RULES_H_
