#ifndef ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_
#define ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_

#include "alidade/identifiability.h"
#include "src/report/table.h"

namespace alidade::internal {

/// Ranks of all candidates and of the free parameters.
Table RankTable(const IdentifiabilityResult& result);

/// Empty where nothing is free.
Table ObservabilityTable(const IdentifiabilityResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_
