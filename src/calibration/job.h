#ifndef ALIDADE_SRC_CALIBRATION_JOB_H_
#define ALIDADE_SRC_CALIBRATION_JOB_H_

#include <string>

#include "alidade/arm.h"
#include "alidade/calibration_result.h"
#include "src/calibration/job_config.h"

namespace alidade::internal {

class IdentifiabilityCache;

enum class JobStatus {
  kDone,          ///< calibrated, all acceptance limits met
  kMissedLimits,  ///< calibrated, but an acceptance limit is missed
  kRefused,       ///< the identifiability pass wants a choice by the user
  kFailed,        ///< the job's solver found no usable solution
};

/// What a job came to. `result` is as complete as the job got: a refused one
/// holds the identifiability analysis, a failed one the solver's summary too.
struct JobOutcome {
  JobStatus status = JobStatus::kFailed;
  std::string message;  ///< empty when done
  CalibrationResult result;
  Arm calibrated;  ///< the nominal arm unless a solver succeeded
};

/// Identifies, solves by the job's solver and by those it is compared with,
/// evaluates training and held-out poses before and after, sets the published
/// study beside it, and checks the acceptance limits. Writes nothing.
/// `command` goes into the result. Data are not copied where `config` is moved
/// in. Results do not depend on `execution`.
///
/// With parts of the data (LoadJob with a communicator) collective: every rank
/// takes the same steps and has the same outcome, but for what has an entry for
/// each pose, observation or outlier, which the root alone has. It is what one
/// process would find, to the bit.
///
/// `cache`: null, or what jobs of one arm and the same poses share; the outcome
/// is the same.
/// @throws InputError where an input file cannot be read again for its hash, or
/// where the measured positions fit the nominal arm nowhere and one slip
/// explains it (units, columns, signs), which the message names.
JobOutcome RunJob(JobConfig config, const std::string& command,
                  const Execution& execution,
                  IdentifiabilityCache* cache = nullptr);

/// The identifiability part of a job alone.
IdentifiabilityResult IdentifyJob(const JobConfig& config, int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CALIBRATION_JOB_H_
