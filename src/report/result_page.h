#ifndef ALIDADE_SRC_REPORT_RESULT_PAGE_H_
#define ALIDADE_SRC_REPORT_RESULT_PAGE_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/arm_view.h"
#include "src/report/page.h"

namespace alidade::internal {

/// report.html of one result, with `further` sections before its own. What a
/// result does not have (arm, sets of observations, map) is left out. Tables
/// hold at most 1000 rows. `result_json` is in the page, which saves it, unless
/// it is longer than 500 kB. `shapes`: of the arm's links, where they are
/// known.
std::string RenderResultPage(const CalibrationResult& result,
                             const std::string& result_json,
                             const std::vector<PageSection>& further,
                             ArmShapes shapes = {});

/// What decides: the verdict, errors before and after, answers, warnings, and
/// the view of the arm unless it is empty.
std::string FirstScreen(const CalibrationResult& result, const ArmView& view);
/// What "before" means, as a note; empty where it is the arm's file.
std::string BeforeNote(const CalibrationResult& result);

// The sections of that page, in their order; without content where the result
// has nothing for them.
PageSection PredictionSection(const CalibrationResult& result);
PageSection ResidualsSection(const CalibrationResult& result);
PageSection ErrorTermsSectionOf(const CalibrationResult& result);
PageSection ParametersSection(const CalibrationResult& result);

/// Accuracy by stage where error terms were weighed. @pre they were.
std::string ErrorStagesPart(const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_RESULT_PAGE_H_
