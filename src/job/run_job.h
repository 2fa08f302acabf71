#ifndef ALIDADE_SRC_JOB_RUN_JOB_H_
#define ALIDADE_SRC_JOB_RUN_JOB_H_

#include <string>
#include <vector>

#include "alidade/calibration_result.h"
#include "alidade/plan.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"
#include "src/serialization/plan_file.h"

namespace alidade::internal {

/// Calibrates as the job says, notes where the result comes from (`command`,
/// the hashes of the files that were read) and the job's published values.
/// Writes nothing. Data are not copied where the job is moved in.
///
/// Collective where several ranks have loaded the job (LoadJob).
///
/// `cache`: null, or what jobs of one arm and the same poses share; the result
/// is the same.
/// @throws InputError as Calibrate, and where an input file cannot be read
/// again for its hash.
CalibrationResult RunJob(JobConfig job, const std::string& command,
                         IdentifiabilityCache* cache = nullptr);

/// PlanPoses, and where the result comes from. @throws InputError.
PlanResult RunPlan(const PlanConfig& config, const std::string& command);

/// poses.csv, plan.txt, accuracy.svg, curve.csv, plan.html and, last,
/// plan.json.
std::vector<ReportFile> RenderPlan(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_JOB_RUN_JOB_H_
