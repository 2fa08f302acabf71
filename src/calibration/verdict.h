#ifndef ALIDADE_SRC_CALIBRATION_VERDICT_H_
#define ALIDADE_SRC_CALIBRATION_VERDICT_H_

#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// Fills `verdict` and the assessment of every parameter from all else that the
/// result holds. Everything that shows a result shows these and decides nothing
/// of its own. The keys of findings are listed in docs/files.md.
void JudgeResult(CalibrationResult* result);

/// How predictions compare with what was observed at `where`, in a sentence;
/// empty where nothing was observed.
std::string DescribePrediction(const std::string& where,
                               const PredictionCheck& check);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_VERDICT_H_
