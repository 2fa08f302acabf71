#ifndef ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_

#include <optional>
#include <string>

#include "alidade/calibration_result.h"
#include "alidade/plan.h"
#include "src/calibration/batch_summary.h"

namespace alidade::internal {

/// Results for machines (docs/files.md): SI units, stable keys, every number
/// with the digits that read back to the same bits, NaN and infinities as null,
/// bytes that are no UTF-8 as U+FFFD. What their keys are stands in the headers
/// *_fields.h beside the structs.

inline constexpr char kResultFormat[] = "alidade-result-2";
inline constexpr char kPlanResultFormat[] = "alidade-plan-result-2";
inline constexpr char kBatchFormat[] = "alidade-batch-2";
/// What to say where such a file is none of those expected.
inline constexpr char kPlanResultIsForMachines[] =
    "is what `alidade plan` has written, for machines: plan.txt beside it says "
    "it in words, and poses.csv is the plan";

/// result.json.
std::string FormatResultJson(const CalibrationResult& result);

/// Reads result.json back as far as `show` needs it: all but the per-pose
/// arrays, which live in residuals.csv. A result of an earlier version, which
/// has no verdict, is judged. @throws InputError.
CalibrationResult LoadResultJson(const std::string& path);
/// The same of a text; `path` is for messages.
CalibrationResult ParseResultJson(const std::string& text,
                                  const std::string& path);

/// What result.json has as its `identifiability`.
std::string FormatIdentifiabilityJson(const IdentifiabilityResult& result);

/// plan.json.
std::string FormatPlanJson(const PlanResult& result);

/// summary.json of a batch (docs/batch.md).
std::string FormatBatchSummary(const BatchSummary& summary);

/// Reads it back. @throws InputError.
BatchSummary LoadBatchSummary(const std::string& path);
/// The same of a text; `path` is for messages.
BatchSummary ParseBatchSummary(const std::string& text,
                               const std::string& path);

/// A record of a journal as one line of JSON, without its line end.
std::string FormatBatchRecord(const BatchRecord& record);

/// Nothing where the line is no record: torn off, or of another program.
std::optional<BatchRecord> ParseBatchRecord(const std::string& line);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_RESULT_JSON_H_
