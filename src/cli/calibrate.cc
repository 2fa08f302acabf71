#include <glog/logging.h>

#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/cli/launch.h"
#include "src/cli/progress.h"
#include "src/cli/shell_word.h"
#include "src/common/text.h"
#include "src/job/report_page.h"
#include "src/job/result_directory.h"
#include "src/job/run_job.h"
#include "src/report/answers.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

void PrintSummary(const CalibrationResult& result,
                  const std::vector<std::string>& paths) {
  std::cout << result.title << "\n\n"
            << Paragraph(result.verdict.title + ". " + result.verdict.sentence)
            << FormatAnswers(result) << "\n"
            << FormatAccuracyTable(result) << "\n"
            << FormatPublished(result);
  PrintResults(paths);
}

// More processes than files are no error: those without one go along.
void WarnOfIdle(const JobConfig& config, const Communicator& communicator) {
  std::set<int> busy(config.readers.begin(), config.readers.end());
  busy.insert(0);
  if (static_cast<int>(busy.size()) == communicator.size()) return;
  LOG(WARNING) << "warning: only " << busy.size() << " of "
               << communicator.size()
               << " processes have a file of data to read: cut the data into "
                  "as many files as there are processes, or more";
}

// What a result that may be used is for.
void PrintNext(const std::string& directory) {
  std::cout << "\nNext: alidade correct " << ShellWord(directory)
            << " PROGRAM  (or targets; docs/robot.md)\n      alidade plan "
            << "--check " << ShellWord(directory)
            << "  (poses that show at the robot "
            << "whether it works)\n";
}

// What is printed and written is so by the root.
ExitStatus Calibrate(const CommandLine& line, Communicator* communicator) {
  const bool is_root = communicator->is_root();
  const std::string& path = line.files.front();
  ProgressLine progress;
  progress.Show("reading " + path);
  JobConfig config = LoadJob(path, {line.threads, communicator});
  WarnOfIdle(config, *communicator);
  ShowIterations(config.data.training.global_poses(), &progress,
                 &config.options.solver_options);
  if (line.seed) config.options.identifiability.seed = *line.seed;
  progress.Clear();
  LogReading(config.data, config.input_files, config.rejected.size());
  const std::string directory = OutputDirectory(line);
  if (is_root) {
    CheckResultDirectory(directory, OutputKind::kCalibration,
                         config.input_files);
  }
  const JobOutputs outputs = config.outputs;
  const CalibrationResult result = RunJob(std::move(config), line.text);
  progress.Clear();
  if (!is_root) return kExitDone;
  LogJob(result);
  const bool is_kept = line.keep_rejected && result.IsRejected();
  if (!result.IsUsable()) PrintError(path + ": " + result.message);
  if (!result.IsUsable() && !is_kept) {
    RemoveResult(directory);
    return kExitNumerical;
  }
  progress.Show("writing " + directory);
  const std::string page = directory + "/report.html";
  const bool had_page = std::filesystem::exists(page);
  std::vector<ReportFile> files = RenderResult(result, outputs);
  if (line.report) {
    // Before result.json, which comes last.
    files.insert(files.end() - 1, MakeResultPage(result));
  }
  const std::vector<std::string> paths = WriteResultDirectory(directory, files);
  progress.Clear();
  PrintSummary(result, paths);
  if (had_page && !std::filesystem::exists(page)) {
    std::cout << "  " << page << " was that of an earlier run, and is removed: "
              << "--report writes it anew\n";
  }
  if (is_kept) return kExitNumerical;
  if (result.status == CalibrationStatus::kMissedLimits) {
    PrintError(path + ": " + result.message + "; " + directory +
               "/report.txt says which");
    return kExitMissedLimits;
  }
  if (result.verdict.decision() != VerdictDecision::kRejected) {
    PrintNext(directory);
  }
  return kExitDone;
}

}  // namespace

ExitStatus RunCalibrate(const CommandLine& line) {
  return RunAsLaunched([&line](Communicator* communicator) {
    return Calibrate(line, communicator);
  });
}

}  // namespace alidade::internal
