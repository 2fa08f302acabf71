#ifndef ALIDADE_SRC_CALIBRATION_STUDY_H_
#define ALIDADE_SRC_CALIBRATION_STUDY_H_

#include "alidade/calibration_result.h"
#include "src/calibration/job_config.h"
#include "src/solve/solver.h"

namespace alidade::internal {

/// What the comparison with a published study is made from; all must outlive
/// the call.
struct StudyInput {
  const JobConfig& config;
  const CalibrationProblem& problem;
  const CalibrationResult& result;  ///< with its runs and evaluated sets
};

/// Sets the job's result beside the study that `config.published` describes:
/// repeats the study's fixed number of iterations of its own algorithm (median
/// time of three), evaluates the identified values rounded as its table prints
/// them, and finds which free parameters took up the frozen ones.
/// @pre config.published; the first run of the result is usable.
StudyResult CompareWithStudy(const StudyInput& input);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_STUDY_H_
