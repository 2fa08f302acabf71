#ifndef ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_

#include <string>

#include "alidade/calibration_result.h"

namespace alidade::internal {

/// A result for machines (docs/files.md, "result.json"): SI units, stable keys,
/// every number with the digits that read back to the same bits, NaN and
/// infinities as null.
std::string FormatResultJson(const CalibrationResult& result);

/// Reads result.json back as far as `show` needs it: all but the per-pose
/// arrays, which live in residuals.csv. A result of an earlier version, which
/// has no verdict, is judged. @throws InputError.
CalibrationResult LoadResultJson(const std::string& path);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_
