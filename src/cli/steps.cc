#include "src/cli/steps.h"

#include <glog/logging.h>

#include "src/common/format.h"

namespace alidade::internal {
namespace {

std::string Seconds(double seconds) {
  return FormatSignificant(seconds, 3) + " s";
}

}  // namespace

void LogReading(const JobConfig& config) {
  LOG(INFO) << "read " << config.data.global_poses() << " poses, "
            << config.data.global_observations() << " measurements"
            << (config.validation
                    ? ", and " +
                          std::to_string(config.validation->global_poses()) +
                          " poses for validation"
                    : "")
            << (config.rejected.empty()
                    ? ""
                    : ", without " + std::to_string(config.rejected.size()) +
                          " rows that measure nothing");
  for (const std::string& path : config.input_files) VLOG(1) << "  " << path;
}

void LogIdentifiability(const IdentifiabilityResult& result) {
  LOG(INFO) << "identifiability: " << result.num_free << " of "
            << result.decisions.size()
            << " parameters are free; these poses tell "
            << result.nominal_rank.rank << " apart";
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
