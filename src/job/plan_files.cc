#include "src/job/plan_files.h"

#include <glog/logging.h>

#include <string>
#include <utility>

#include "src/common/files.h"
#include "src/dataio/dataset_csv.h"
#include "src/report/plan_report.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {

PlanResult RunPlan(const PlanConfig& config, const std::string& command) {
  std::vector<InputFile> inputs;
  for (const std::string& path : config.input_files) {
    inputs.push_back({path, Sha256OfFile(path)});
  }
  PlanResult result = WithFileInErrors(config.path, [&config] {
    return PlanPoses(config.job.arm, config.job.data, config.job.options,
                     config);
  });
  result.command = command;
  result.title = config.title;
  result.inputs = std::move(inputs);
  for (const std::string& warning : result.warnings) {
    LOG(WARNING) << "warning: " << warning;
  }
  return result;
}

std::vector<ReportFile> RenderPlan(const PlanResult& result) {
  const std::vector<std::string> comments = {
      result.title,
      "poses planned by alidade " + result.version + " for " + result.arm +
          ", in an order with little travel",
      "seed: " + std::to_string(result.seed) +
          "; fill in what is measured, or take the joint values alone"};
  std::vector<ReportFile> files;
  files.emplace_back("poses.csv",
                     FormatDataset(result.sheet, result.planned_arm,
                                   result.joint_decimals, false, comments));
  files.emplace_back("plan.txt", FormatPlan(result));
  for (ReportFile& file : MakePlanFiles(result)) {
    files.push_back(std::move(file));
  }
  files.emplace_back("plan.json", FormatPlanJson(result));
  return files;
}

}  // namespace alidade::internal
