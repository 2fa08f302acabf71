#ifndef ALIDADE_SRC_REPORT_UNCERTAINTY_REPORT_H_
#define ALIDADE_SRC_REPORT_UNCERTAINTY_REPORT_H_

#include <string>

#include "alidade/calibration_result.h"
#include "src/report/table.h"

namespace alidade::internal {

/// The section of report.txt: intervals, what can only be determined together,
/// the residuals, what is predicted over the workspace and at validation poses.
/// Empty where it was not assessed.
std::string UncertaintySection(const CalibrationResult& result);

/// In one paragraph.
std::string DescribeMap(const PredictedMap& map);

/// Predicted and measured accuracy by distance from the base's axis and height,
/// nine regions; empty without a map of the workspace.
Table RegionTable(const CalibrationResult& result);

/// The residuals beside the noise, and what they depend on, in one paragraph.
std::string DescribeLackOfFit(const UncertaintyResult& uncertainty);
/// The strongest tests of that; empty where there were none.
Table StructureTable(const LackOfFit& lack);

/// The poses that the result depends on most; empty where none is known.
Table InfluenceTable(const ResidualDiagnostics& residuals);
Table CorrelationTable(const UncertaintyResult& uncertainty);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_UNCERTAINTY_REPORT_H_
