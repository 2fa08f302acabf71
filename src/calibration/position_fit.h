#ifndef ALIDADE_SRC_CALIBRATION_POSITION_FIT_H_
#define ALIDADE_SRC_CALIBRATION_POSITION_FIT_H_

#include "alidade/arm.h"
#include "alidade/identifiability.h"
#include "src/calibration/position_sample.h"

namespace alidade::internal {

/// Median residual of the nominal arm with any base and tool (m); infinite
/// where no fit succeeds.
double Misfit(const Arm& arm, const PositionSample& sample);

/// The root mean square of the same.
double RmsMisfit(const Arm& arm, const PositionSample& sample);

/// The median with the target as the arm states it and a base that fits all of
/// them best: one way to place the arm, found at a fraction of the cost of the
/// best one.
double MisfitAsStated(const Arm& arm, const PositionSample& sample);

/// The median error at a third of the positions of the arm that is calibrated
/// with the others (m): what `candidates` name, by default all.
double SolvedMisfit(const Arm& arm, const PositionSample& sample,
                    bool with_wide_priors = false,
                    const CandidateGroups& candidates = {true, true, true});

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_POSITION_FIT_H_
