#include "src/calibration/batch_summary.h"

#include <algorithm>

namespace alidade::internal {

std::int64_t BatchSummary::Count(BatchStatus status) const {
  return std::count_if(
      entries.begin(), entries.end(),
      [status](const BatchEntry& entry) { return entry.status == status; });
}

BatchStatus BatchSummary::Worst() const {
  BatchStatus worst = BatchStatus::kNotRun;
  for (const BatchEntry& entry : entries) {
    worst = std::max(worst, entry.status);
  }
  return worst;
}

}  // namespace alidade::internal
