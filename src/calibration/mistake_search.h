#ifndef ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_
#define ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_

#include <optional>

#include "alidade/arm.h"
#include "alidade/identifiability.h"
#include "src/calibration/plausibility.h"
#include "src/calibration/position_sample.h"

namespace alidade::internal {

/// Which mistakes of the input explain that the positions of `sample` do not
/// fit the arm, as DiagnoseInput says; nothing where they fit. `inverse`: the
/// same of the inverse poses, where poses were measured. `sigma`: of a position
/// (m). Takes milliseconds, or about a second where they do not fit.
InputDiagnosis FindMistakes(const Arm& arm, const PositionSample& sample,
                            const std::optional<PositionSample>& inverse,
                            const CandidateGroups& candidates, double sigma);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_
