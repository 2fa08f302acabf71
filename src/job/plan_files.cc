#include "src/job/plan_files.h"

#include <string>
#include <utility>

#include "src/dataio/dataset_csv.h"
#include "src/report/plan_report.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {

std::vector<ReportFile> RenderPlan(const PlanOutcome& outcome) {
  const PlanResult& result = outcome.result;
  const std::vector<std::string> comments = {
      result.title,
      "poses planned by alidade " + result.version + " for " + result.arm +
          ", in an order with little travel",
      "seed: " + std::to_string(result.seed) +
          "; fill in what is measured, or take the joint values alone"};
  std::vector<ReportFile> files;
  files.emplace_back("poses.csv",
                     FormatDataset(outcome.sheet, outcome.arm,
                                   outcome.joint_decimals, false, comments));
  files.emplace_back("plan.txt", FormatPlan(result));
  for (ReportFile& file : MakePlanFiles(result)) {
    files.push_back(std::move(file));
  }
  files.emplace_back("plan.json", FormatPlanJson(result));
  return files;
}

}  // namespace alidade::internal
