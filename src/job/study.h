#ifndef ALIDADE_SRC_JOB_STUDY_H_
#define ALIDADE_SRC_JOB_STUDY_H_

#include "alidade/calibration_result.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {

/// Sets the job's result beside the study that `published` describes:
/// repeats the study's fixed number of iterations of its own algorithm (median
/// time of three), evaluates the identified values rounded as its table prints
/// them, and finds which free parameters took up the frozen ones.
/// `task` is what was calibrated, its frames known. @pre a usable result.
StudyResult CompareWithStudy(const PublishedStudy& published,
                             const CalibrationTask& task,
                             const CalibrationResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_STUDY_H_
