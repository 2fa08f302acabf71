#include <filesystem>
#include <iostream>

#include "alidade/batch/job.h"
#include "alidade/batch/result_directory.h"
#include "alidade/batch/simulate.h"
#include "alidade/report/report.h"
#include "command.h"
#include "progress_line.h"

namespace alidade {
namespace {

std::string DefaultDirectory(const std::string& job) {
  return "results/" + std::filesystem::path(job).stem().string();
}

void PrintSummary(const JobResult& result,
                  const std::vector<std::string>& paths) {
  std::cout << result.title << "\n\n"
            << FormatAccuracyTable(result) << "\n"
            << FormatStudyTable(result);
  std::cout << "\nResults\n";
  for (const std::string& path : paths) std::cout << "  " << path << "\n";
}

}  // namespace

ExitStatus RunCalibrate(const CommandLine& line) {
  const std::string& path = line.files.front();
  ProgressLine progress;
  progress.Show("reading " + path);
  JobConfig config = ReadJob(path, line.threads);
  ShowIterations(config.data.num_poses(), &progress, &config.solver_options);
  if (line.seed) config.identifiability.seed = *line.seed;
  const JobOutcome outcome = RunJob(config, line.text, line.threads);
  progress.Clear();
  if (outcome.status == JobStatus::kRefused ||
      outcome.status == JobStatus::kFailed) {
    PrintError(path + ": " + outcome.message);
    return kExitNumerical;
  }
  const std::string directory =
      line.out.empty() ? DefaultDirectory(path) : line.out;
  PrintSummary(
      outcome.result,
      WriteResultDirectory(directory, RenderResult(outcome, config.outputs)));
  if (outcome.status == JobStatus::kMissedLimits) {
    PrintError(path + ": " + outcome.message + "; " + directory +
               "/report.txt tells which");
    return kExitMissedLimits;
  }
  return kExitDone;
}

}  // namespace alidade
