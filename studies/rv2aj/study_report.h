#ifndef ALIDADE_STUDIES_RV2AJ_STUDY_REPORT_H_
#define ALIDADE_STUDIES_RV2AJ_STUDY_REPORT_H_

#include <string>
#include <vector>

#include "alidade/job.h"
#include "studies/rv2aj/study.h"

namespace alidade::rv2aj {

/// The study's tables beside ours, what explains where they differ, and its
/// five figures, of those of a result. Its tables and what compares with them
/// are in mm and rad, as it prints them.
ReportSection MakeStudySection(const StudyResult& study,
                               const std::vector<ReportFigure>& figures);

/// study.json (docs/files.md).
std::string FormatStudyJson(const StudyResult& study);

}  // namespace alidade::rv2aj

#endif  // ALIDADE_STUDIES_RV2AJ_STUDY_REPORT_H_
