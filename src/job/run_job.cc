#include "src/job/run_job.h"

#include <glog/logging.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/calibration_task.h"
#include "src/common/files.h"
#include "src/dataio/dataset_csv.h"
#include "src/job/arm_shapes.h"
#include "src/report/plan_page.h"
#include "src/report/report.h"
#include "src/serialization/partitioned_data.h"
#include "src/serialization/result_json.h"

namespace alidade::internal {

namespace {

// Every file by a rank that has read it.
std::vector<InputFile> HashInputs(const JobConfig& job) {
  std::vector<InputFile> files;
  std::vector<std::string> mine;
  for (std::size_t k = 0; k < job.input_files.size(); ++k) {
    const bool is_mine =
        (job.readers.empty() ? 0 : job.readers[k]) == job.communicator->rank();
    files.push_back({job.input_files[k], ""});
    if (is_mine) files.back().sha256 = Sha256OfFile(files.back().path);
    mine.push_back(files.back().sha256);
  }
  for (const auto& hashes : TextsOfRanks(job.communicator, mine)) {
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (!hashes[k].empty()) files[k].sha256 = hashes[k];
    }
  }
  return files;
}

// A deviation of zero is one that the publication does not state.
void NotePublished(const PublishedStudy& published, CalibrationResult* result) {
  result->published_source = published.source;
  for (std::size_t c = 0; c < result->parameters.size(); ++c) {
    const double deviation = published.deviations[static_cast<int>(c)];
    if (deviation == 0.0) continue;
    ParameterResult& parameter = result->parameters[c];
    parameter.published = parameter.nominal + deviation;
  }
}

void Log(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    LOG(WARNING) << "warning: " << warning;
  }
}

}  // namespace

CalibrationResult RunJob(JobConfig job, const std::string& command,
                         IdentifiabilityCache* cache) {
  std::vector<InputFile> inputs = HashInputs(job);
  CalibrationResult result =
      Calibrate(static_cast<CalibrationTask&&>(job), cache);
  result.command = command;
  result.title = job.title;
  result.inputs = std::move(inputs);
  result.rejected = std::move(job.rejected);
  if (job.published) NotePublished(*job.published, &result);
  Log(result.identifiability.warnings);
  Log(result.warnings);
  return result;
}

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
  Log(result.warnings);
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
  const std::string json = FormatPlanJson(result);
  if (result.status == PlanStatus::kDone) {
    files.emplace_back(
        "plan.html",
        RenderPlanPage(result, json,
                       ShapesOf(result.inputs, result.planned_arm)));
  }
  files.emplace_back("plan.json", json);
  return files;
}

}  // namespace alidade::internal
