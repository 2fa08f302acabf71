#ifndef ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_
#define ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_

#include "alidade/identifiability_result.h"
#include "src/report/report_table.h"

namespace alidade::internal {

/// Ranks of all candidates and of the free parameters.
ReportTable RankTable(const IdentifiabilityResult& result);

/// Empty where nothing is free.
ReportTable ObservabilityTable(const IdentifiabilityResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_IDENTIFIABILITY_REPORT_H_
