#ifndef ALIDADE_SRC_CALIBRATION_VERDICT_H_
#define ALIDADE_SRC_CALIBRATION_VERDICT_H_

#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Standard errors of a mean change of errors beyond which it is no chance.
inline constexpr double kBeyondChance = 3.0;

/// Fills `verdict` and the assessment of every parameter from all else that the
/// result holds. Everything that shows a result shows these and decides nothing
/// of its own. The keys of findings are listed in docs/files.md.
void JudgeResult(CalibrationResult* result);

/// How predictions compare with what was observed at `where`, in a sentence;
/// empty where nothing was observed.
std::string DescribePrediction(const std::string& where,
                               const PredictionCheck& check);

/// The set that a result is judged by: the validation poses, where there are
/// any, else those of the fit.
const EvaluatedSet& JudgedSet(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_VERDICT_H_
