#ifndef ALIDADE_SRC_CALIBRATION_IMPROVEMENT_H_
#define ALIDADE_SRC_CALIBRATION_IMPROVEMENT_H_

#include <cstdint>
#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Standard errors of a mean change of errors beyond which it is no chance.
inline constexpr double kBeyondChance = 3.0;

/// The set that a result is judged by: the validation poses, where there are
/// any, else those of the fit.
const EvaluatedSet& JudgedSet(const CalibrationResult& result);

/// "position error", or "length error" where lengths alone were measured, such
/// as distances and contacts with planes.
const char* LengthErrorName(const EvaluatedSet& set);
const char* LengthErrorName(const CalibrationResult& result);

/// "validation pose"; "validation observation" where poses have several.
/// `poses` is "training" or "validation".
std::string ObservationName(const EvaluatedSet& set, const char* poses);
/// Of the set that it is judged by.
std::string ObservationName(const CalibrationResult& result);

/// Whether errors grew by more than chance (where it is known what chance would
/// do) and by more than the uncertainty of
/// the parameters explains, which is no fault where the arm was right before.
bool IsWorse(const KeptErrors& judged, const CalibrationResult& result);

/// Mean errors before and after, of positions, or of orientations alone,
/// without rejected observations.
struct Improvement {
  explicit Improvement(const CalibrationResult& result);

  double ratio() const { return after.mean / before.mean; }

  Dimension dimension = Dimension::kLength;
  Accuracy before;
  Accuracy after;
  bool is_worse = false;
  /// Frames alone are identified, which "before" has fitted as well.
  bool is_of_frames = false;
  std::int64_t num_rejected = 0;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_IMPROVEMENT_H_
