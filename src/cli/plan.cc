#include <iostream>

#include "src/cli/command.h"
#include "src/cli/progress.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/report/report.h"
#include "src/serialization/plan_file.h"

namespace alidade::internal {

ExitStatus RunPlanCommand(const CommandLine& line) {
  if (line.check) return RunCheckPlan(line);
  const std::string& path = line.files.front();
  ProgressLine progress;
  progress.Show("planning " + path);
  PlanConfig config = LoadPlan(path, line.threads);
  if (line.seed) config.seed = *line.seed;
  const std::string directory = OutputDirectory(line);
  CheckResultDirectory(directory, OutputKind::kPlan, config.input_files);
  progress.Clear();
  LogReading(config.job.data, config.input_files);
  progress.Show("planning " + path);
  config.job.options.num_threads = line.threads;
  const PlanResult result = RunPlan(config, line.text);
  progress.Clear();
  LogPlan(result);
  if (result.status != PlanStatus::kDone) {
    PrintError(path + ": " + result.message);
    return kExitNumerical;
  }
  const std::vector<std::string> paths =
      WriteResultDirectory(directory, RenderPlan(result));
  std::cout << config.title << "\n\n" << FormatPlanSummary(result);
  PrintResults(paths);
  return kExitDone;
}

}  // namespace alidade::internal
