#include <iostream>

#include "src/calibration/job.h"
#include "src/cli/command.h"
#include "src/cli/steps.h"
#include "src/job/result_directory.h"
#include "src/report/report.h"
#include "src/serialization/job_file.h"
#include "src/simulation/noise_study.h"

namespace alidade::internal {

ExitStatus RunCompare(const CommandLine& line) {
  const std::string& path = line.files.front();
  JobConfig config = LoadJob(path, line.threads);
  if (!line.out.empty()) {
    CheckResultDirectory(line.out, OutputKind::kComparison, config.input_files);
  }
  if (line.seed) {
    config.identifiability.seed = *line.seed;
    if (config.noise_study) config.noise_study->seed = *line.seed;
  }
  config.compare_with = {SolverName::kCeres, SolverName::kPseudoInverse};
  // Solvers are compared on the data; what a study published, and whether the
  // result is good enough, is for calibrate to say.
  config.published.reset();
  config.acceptance = {};
  LogReading(config);
  const JobOutcome outcome = RunJob(config, line.text, line.threads);
  LogJob(outcome.result);
  if (outcome.status == JobStatus::kRefused ||
      outcome.status == JobStatus::kFailed) {
    PrintError(path + ": " + outcome.message);
    return kExitNumerical;
  }
  std::string text =
      outcome.result.title + "\n\n" + FormatComparison(outcome.result);
  std::vector<ReportFile> files = MakeCsvFiles(outcome.result);
  const auto add = [&files](std::vector<ReportFile> more) {
    for (ReportFile& file : more) files.push_back(std::move(file));
  };
  add(MakeFigures(outcome.result));
  if (config.noise_study) {
    const NoiseStudyResult study = RunNoiseStudy(config, line.threads);
    text += "\n" + FormatNoiseStudy(study);
    add(MakeNoiseFiles(study));
  }
  std::cout << text;
  if (line.out.empty()) return kExitDone;
  files.emplace_back("comparison.txt", text);
  std::cout << "\nResults\n";
  for (const std::string& written : WriteResultDirectory(line.out, files)) {
    std::cout << "  " << written << "\n";
  }
  return kExitDone;
}

}  // namespace alidade::internal
