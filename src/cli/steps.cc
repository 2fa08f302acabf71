#include "src/cli/steps.h"

#include <glog/logging.h>

#include "src/common/format.h"

namespace alidade::internal {
namespace {

std::string Seconds(double seconds) {
  return FormatSignificant(seconds, 3) + " s";
}

}  // namespace

void LogReading(const CalibrationData& data,
                const std::vector<std::string>& input_files,
                std::size_t rejected_rows) {
  LOG(INFO) << "read " << data.training.global_poses() << " poses, "
            << data.training.global_observations() << " measurements"
            << (data.validation
                    ? ", and " +
                          std::to_string(data.validation->global_poses()) +
                          " poses for validation"
                    : "")
            << (rejected_rows == 0
                    ? ""
                    : ", without " + std::to_string(rejected_rows) +
                          " rows that measure nothing");
  for (const std::string& path : input_files) VLOG(1) << "  " << path;
}

void LogIdentifiability(const IdentifiabilityResult& result) {
  LOG(INFO) << "identifiability: " << result.num_free << " of "
            << result.decisions.size()
            << " parameters are free; these poses determine "
            << result.nominal_rank.rank << " of them";
  for (const ParameterDecision& decision : result.decisions) {
    if (decision.reason.empty()) continue;
    VLOG(1) << "  " << decision.name << ": " << decision.reason;
  }
}

void LogJob(const CalibrationResult& result) {
  LogIdentifiability(result.identifiability);
  for (const SolverRun& run : result.runs) {
    LOG(INFO) << "solved: " << run.summary.BriefReport();
    VLOG(1) << run.summary.FullReport();
  }
  LOG(INFO) << "time: identifiability " << Seconds(result.identify_time_s)
            << ", in all " << Seconds(result.total_time_s);
}

void LogPlan(const PlanResult& result) {
  LOG(INFO) << "candidates: " << result.num_candidates << " of "
            << result.num_looked_at << " satisfy the constraints";
  LOG(INFO) << "chosen: " << result.joint_values.cols() << " poses by "
            << result.exchanges << " exchanges in " << result.passes
            << " passes, " << Seconds(result.plan_time_s);
}

}  // namespace alidade::internal
