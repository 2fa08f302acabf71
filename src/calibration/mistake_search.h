#ifndef ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_
#define ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_

#include <Eigen/Core>
#include <optional>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "alidade/identifiability.h"
#include "src/calibration/position_sample.h"

namespace alidade::internal {

struct InputDiagnosis {
  /// The median residual against the tolerated one (m), or the number of lost
  /// targets; nothing where nothing is wrong.
  std::optional<Finding> finding;
  /// The sentence says what to mend, and nothing is to be fitted before.
  bool is_explained = false;
  /// The number of the position, among those of the first target, from which on
  /// another station measured; 0: there is one station.
  Eigen::Index first_of_second_station = 0;
};

/// Which mistakes of the input explain that the positions of `sample` do not
/// fit the arm, as DiagnoseInput says (plausibility.h); nothing where they fit.
/// `inverse`: the same of the inverse poses, where poses were measured.
/// `sigma`: of a position (m). Takes milliseconds, or about a second where they
/// do not fit.
InputDiagnosis FindMistakes(const Arm& arm, const PositionSample& sample,
                            const std::optional<PositionSample>& inverse,
                            const CandidateGroups& candidates, double sigma);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_MISTAKE_SEARCH_H_
