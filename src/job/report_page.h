#ifndef ALIDADE_SRC_JOB_REPORT_PAGE_H_
#define ALIDADE_SRC_JOB_REPORT_PAGE_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/comparison_page.h"
#include "src/report/page.h"
#include "src/report/report.h"

namespace alidade::internal {

/// report.html of a result that was just computed, with further sections.
ReportFile MakeResultPage(const CalibrationResult& result,
                          const std::vector<PageSection>& further = {});

/// The page of a result directory, or of its result.json; further files of the
/// directory are used where they are there. @throws InputError.
std::string ResultPageOf(const std::string& path,
                         const std::vector<PageSection>& further = {});

/// Adds a result directory, or a result.json, to a comparison page that will
/// be written to `page_path`; links to its report.html where there is one.
/// @throws InputError.
void AddToComparison(const std::string& path, const std::string& label,
                     const std::string& page_path, ComparisonPage* page);

/// Names by which results in these directories are distinguished: the last
/// parts of their paths, as many as it takes. One entry per path.
std::vector<std::string> ResultLabels(const std::vector<std::string>& paths);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_REPORT_PAGE_H_
