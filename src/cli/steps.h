#ifndef ALIDADE_SRC_CLI_STEPS_H_
#define ALIDADE_SRC_CLI_STEPS_H_

#include "alidade/calibration_options.h"
#include "alidade/calibration_result.h"
#include "alidade/plan.h"

namespace alidade::internal {

// What --verbosity=1 writes to standard error, a line a step, and 2 in detail.

/// What a job has read.
void LogReading(const CalibrationData& data,
                const std::vector<std::string>& input_files,
                std::size_t rejected_rows = 0);

/// What the identifiability pass has found.
void LogIdentifiability(const IdentifiabilityResult& result);

/// What a job has done, as far as it got.
void LogJob(const CalibrationResult& result);

/// What a plan has looked at and chosen.
void LogPlan(const PlanResult& result);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_CLI_STEPS_H_
