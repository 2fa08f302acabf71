#ifndef ALIDADE_SRC_JOB_REPORT_PAGE_H_
#define ALIDADE_SRC_JOB_REPORT_PAGE_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "src/report/html_report.h"
#include "src/report/report.h"

namespace alidade::internal {

/// report.html of the job whose other files RenderResult made, for a directory
/// of this path; `sections`: ReportSource.
ReportFile MakeResultPage(const CalibrationResult& result,
                          const std::vector<ReportFile>& files,
                          const std::string& directory,
                          const std::string& sections = "");

/// The page of a result directory, or of its result.json; further files of the
/// directory are used where they are there. @throws InputError.
std::string ResultPageOf(const std::string& path);

/// Adds a result directory, or a result.json, to a comparison page that will
/// be written to `page_path`; links to its report.html where there is one.
/// @throws InputError.
void AddToComparison(const std::string& path, const std::string& label,
                     const std::string& page_path, ComparisonPage* page);

/// Names by which results in these directories are told apart: the last parts
/// of their paths, as many as it takes. One entry per path.
std::vector<std::string> ResultLabels(const std::vector<std::string>& paths);

/// The arm as a chain of links at up to 60 poses of residuals.csv; nothing
/// where the table has no joint values of this arm.
std::optional<ArmPicture> PictureOf(const Arm& arm,
                                    const TextSource& residuals_csv);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_REPORT_PAGE_H_
