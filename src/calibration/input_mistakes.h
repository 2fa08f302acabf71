#ifndef ALIDADE_SRC_CALIBRATION_INPUT_MISTAKES_H_
#define ALIDADE_SRC_CALIBRATION_INPUT_MISTAKES_H_

#include <functional>
#include <string>
#include <vector>

#include "alidade/arm.h"
#include "src/calibration/position_sample.h"

namespace alidade::internal {

/// A mistake that people make with their data, and its cure.
struct InputMistake {
  /// Mistakes of the same kind do not go together: an angle is in one unit.
  /// One column's unit goes with no other.
  enum class Kind { kAngleUnit, kLengthUnit, kMirror, kRow, kJoint, kColumn };

  Kind kind = Kind::kJoint;
  std::string text;  ///< what the user should do
  std::function<void(PositionSample*)> mend;
};

/// Mistakes of units (deg, rad, grad; m, cm, mm, inches, feet), of all columns
/// or of a single one (deg, rad; m, mm), of axes, of rows that are one late or
/// early, of joints that count the other way or from a zero 90 or 180 deg
/// elsewhere, of joints that are swapped, in reversed order, coupled to the one
/// before, or one row off alone.
std::vector<InputMistake> SingleMistakes(const Arm& arm);

/// Every two of them that can come together, but for those of these texts.
std::vector<InputMistake> DoubleMistakes(
    const Arm& arm, const std::vector<std::string>& without);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_INPUT_MISTAKES_H_
