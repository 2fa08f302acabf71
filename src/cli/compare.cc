#include <iostream>

#include "src/cli/command.h"
#include "src/cli/progress.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"
#include "src/simulation/noise_study.h"

namespace alidade::internal {

ExitStatus RunCompare(const CommandLine& line) {
  const std::string& path = line.files.front();
  JobConfig config = LoadJob(path, line.threads);
  if (!line.out.empty()) {
    CheckResultDirectory(line.out, OutputKind::kComparison, config.input_files);
  }
  if (line.seed) {
    config.options.identifiability.seed = *line.seed;
    if (config.noise_study) config.noise_study->seed = *line.seed;
  }
  config.options.compare_with = {SolverName::kCeres,
                                 SolverName::kPseudoInverse};
  // Solvers are compared on the data; what a study published, and whether the
  // result is good enough, is for calibrate to say.
  config.published.reset();
  config.options.acceptance = {};
  LogReading(config.data, config.input_files, config.rejected.size());
  const CalibrationResult result = RunJob(config, line.text);
  LogJob(result);
  if (!result.IsUsable()) {
    PrintError(path + ": " + result.message);
    return kExitNumerical;
  }
  std::string text = result.title + "\n\n" + FormatComparison(result);
  std::vector<ReportFile> files = MakeCsvFiles(result);
  const auto add = [&files](std::vector<ReportFile> more) {
    for (ReportFile& file : more) files.push_back(std::move(file));
  };
  add(MakeFigures(result));
  if (config.noise_study) {
    const NoiseStudyResult study = RunNoiseStudy(config, *config.noise_study);
    text += "\n" + FormatNoiseStudy(study);
    add(MakeNoiseFiles(study));
  }
  std::cout << text;
  if (line.out.empty()) return kExitDone;
  files.emplace_back("comparison.txt", text);
  PrintResults(WriteResultDirectory(line.out, files));
  return kExitDone;
}

}  // namespace alidade::internal
