#ifndef ALIDADE_SRC_SERIALIZATION_BATCH_JSON_H_
#define ALIDADE_SRC_SERIALIZATION_BATCH_JSON_H_

#include <optional>
#include <string>

#include "src/calibration/batch_summary.h"

namespace alidade::internal {

/// summary.json of a batch (docs/batch.md): SI units, numbers with the digits
/// that read back to the same bits, NaN as null, bytes that are no UTF-8 as
/// U+FFFD.
std::string FormatBatchSummary(const BatchSummary& summary);

/// Reads it back. @throws InputError.
BatchSummary LoadBatchSummary(const std::string& path);

/// A record of a journal as one line of JSON, without its line end.
std::string FormatBatchRecord(const BatchRecord& record);

/// Nothing where the line is no record: torn off, or of another program.
std::optional<BatchRecord> ParseBatchRecord(const std::string& line);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SERIALIZATION_BATCH_JSON_H_
