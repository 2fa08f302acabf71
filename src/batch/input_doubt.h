#ifndef ALIDADE_SRC_BATCH_INPUT_DOUBT_H_
#define ALIDADE_SRC_BATCH_INPUT_DOUBT_H_

#include <string>

#include "alidade/measurement/dataset.h"
#include "alidade/model/arm.h"

namespace alidade {

struct InputDoubt {
  std::string text;           ///< empty where nothing is wrong
  bool is_explained = false;  ///< by one slip, which the text names
};

/// What speaks against the data before anything is calibrated: measured
/// positions that fit the nominal arm nowhere, whatever base and tool, to
/// within 2 % of the arm's own reach (median). Where one slip that people make
/// would explain it, by a misfit that is at least four times smaller and within
/// those 2 %, the text names it: degrees taken for radians or the reverse, mm
/// for m, two joints or two axes swapped, a joint that counts backwards,
/// measurements one row late or early. Nothing is said where fewer than twelve
/// positions of the first target were measured. Looks at 60 positions.
InputDoubt DoubtInput(const Arm& arm, const Dataset& data);

}  // namespace alidade

#endif  // ALIDADE_SRC_BATCH_INPUT_DOUBT_H_
