#ifndef ALIDADE_SRC_FLEET_BATCH_CSV_H_
#define ALIDADE_SRC_FLEET_BATCH_CSV_H_

#include <string>

#include "src/calibration/batch_summary.h"

namespace alidade::internal {

/// summary.csv of a batch (docs/batch.md): a row per job, in the order of the
/// jobs; lengths in mm with the digits that read back to the same bits; empty
/// cells for what a job does not have.
std::string FormatBatchCsv(const BatchSummary& summary);

/// "done", "missed limits" ...
const char* ToString(BatchStatus status);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_FLEET_BATCH_CSV_H_
