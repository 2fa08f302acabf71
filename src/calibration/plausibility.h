#ifndef ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_
#define ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_

#include <optional>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

struct InputDiagnosis {
  /// The median misfit against the tolerated one (m); nothing where nothing is
  /// wrong.
  std::optional<Finding> finding;
  bool is_explained = false;  ///< by one mistake, which the sentence names
};

/// What speaks against the data before anything is calibrated: measured
/// positions that fit the nominal arm with no base and tool to within 2 % of
/// the arm's own reach (median). Where one input mistake that people make would
/// explain it, by a misfit that is at least four times smaller and within those
/// 2 %, the sentence names it: degrees taken for radians or the reverse, mm
/// for m, cm or inches for mm, two joints or two axes swapped, a joint that
/// counts backwards or from a zero 90 or 180 deg elsewhere, measurements one
/// row late or early. A misfit explains nothing unless it is small beside how
/// far the positions lie apart. Nothing is said where fewer than twelve
/// positions of the first target were measured. Looks at 60 positions.
InputDiagnosis DiagnoseInput(const Arm& arm, const Dataset& data,
                             Communicator* communicator = SingleProcess());

/// Positions that are exactly 0, 0, 0, if any: the finding's statistic is their
/// number. Collective (kernel/partition.h).
std::optional<Finding> DiagnoseZeros(
    const Dataset& data, Communicator* communicator = SingleProcess());

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_PLAUSIBILITY_H_
