#ifndef ALIDADE_SRC_CALIBRATION_INPUT_DOUBT_H_
#define ALIDADE_SRC_CALIBRATION_INPUT_DOUBT_H_

#include <string>

#include "alidade/arm.h"
#include "alidade/communicator.h"
#include "alidade/dataset.h"

namespace alidade::internal {

struct InputDoubt {
  std::string text;           ///< empty where nothing is wrong
  bool is_explained = false;  ///< by one slip, which the text names
};

/// What speaks against the data before anything is calibrated: measured
/// positions that fit the nominal arm nowhere, whatever base and tool, to
/// within 2 % of the arm's own reach (median). Where one slip that people make
/// would explain it, by a misfit that is at least four times smaller and within
/// those 2 %, the text names it: degrees taken for radians or the reverse, mm
/// for m, cm or inches for mm, two joints or two axes swapped, a joint that
/// counts backwards or from a zero 90 or 180 deg elsewhere, measurements one
/// row late or early. A misfit explains nothing unless it is small beside how
/// far the positions lie apart. Nothing is said where fewer than twelve
/// positions of the first target were measured. Looks at 60 positions.
InputDoubt DoubtInput(const Arm& arm, const Dataset& data,
                      Communicator* communicator = SingleProcess());

/// What to say of positions that are exactly 0, 0, 0; empty where there are
/// none. Collective (partition.h).
std::string DoubtZeros(const Dataset& data,
                       Communicator* communicator = SingleProcess());

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_INPUT_DOUBT_H_
