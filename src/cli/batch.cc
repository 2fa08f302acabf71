#include "src/fleet/batch.h"

#include <glog/logging.h>

#include <algorithm>
#include <iostream>

#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/cli/launch.h"
#include "src/cli/progress.h"
#include "src/common/text.h"
#include "src/serialization/job_list.h"

namespace alidade::internal {
namespace {

constexpr char kDefaultDirectory[] = "results/batch";

std::vector<std::string> PathsOf(const CommandLine& line) {
  std::vector<std::string> paths = line.files;
  if (!line.list.empty()) {
    for (std::string& path : ReadJobList(line.list)) {
      paths.push_back(std::move(path));
    }
  }
  if (paths.empty()) {
    throw InputError({},
                     "batch: no jobs, expected JOB.yaml..., a folder or "
                     "--list=FILE; 'alidade batch --help' says more");
  }
  return paths;
}

std::optional<JobOutputs> OutputsOf(const CommandLine& line) {
  if (line.outputs.empty()) return std::nullopt;
  const std::vector<std::string> words = WordsOf<JobOutputs>();
  if (std::find(words.begin(), words.end(), line.outputs) == words.end()) {
    throw InputError({}, "batch: --outputs = \"" + line.outputs +
                             "\", expected " + Join(words, " or "));
  }
  return ValueOf<JobOutputs>(line.outputs);
}

ExitStatus ExitStatusOf(BatchStatus worst) {
  switch (worst) {
    case BatchStatus::kNotRun:
    case BatchStatus::kDone:
      return kExitDone;
    case BatchStatus::kMissedLimits:
      return kExitMissedLimits;
    case BatchStatus::kBadInput:
      return kExitBadInput;
    case BatchStatus::kFailed:
      return kExitNumerical;
  }
  return kExitNumerical;
}

// One line a job. Ends with the worst that is known without running any.
ExitStatus PrintPlan(const BatchPlan& plan, const BatchOptions& options) {
  const std::vector<bool> done = FindDone(plan, options);
  ExitStatus status = kExitDone;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const PlannedJob& job = plan.jobs[i];
    if (job.matrix < 0) {
      PrintError(job.name + ": " + job.error);
      status = kExitBadInput;
      continue;
    }
    const JobOutline outline = plan.matrices[job.matrix].OutlineOf(job.number);
    std::cout << job.name << ": arm " << outline.arm << ", data "
              << outline.data << ", to " << options.directory << "/" << job.name
              << (done[i] ? " (done)" : "") << "\n";
  }
  return status;
}

void PrintSummary(const BatchSummary& summary, const BatchOptions& options) {
  std::cout << summary.entries.size()
            << (summary.entries.size() == 1 ? " job" : " jobs");
  for (const BatchStatus status :
       {BatchStatus::kDone, BatchStatus::kMissedLimits, BatchStatus::kBadInput,
        BatchStatus::kFailed, BatchStatus::kNotRun}) {
    const std::int64_t count = summary.Count(status);
    if (count > 0) std::cout << ", " << count << " " << ToString(status);
  }
  std::cout << "\n";
  if (!summary.comparison.empty()) std::cout << summary.comparison << "\n";
  PrintResults({options.directory + "/summary.csv",
                options.directory + "/summary.json",
                options.directory + "/comparison.html"});
}

// What is printed is so by the root.
ExitStatus Run(const CommandLine& line, Communicator* communicator) {
  BatchOptions options;
  options.directory = line.out.empty() ? kDefaultDirectory : line.out;
  options.num_threads = line.threads;
  options.fail_fast = line.fail_fast;
  options.outputs = OutputsOf(line);
  const bool is_root = communicator->is_root();
  const BatchPlan plan = PlanBatch(PathsOf(line));
  if (line.dry_run) return is_root ? PrintPlan(plan, options) : kExitDone;
  // Warnings are in the results and counted in the summary; those of a thousand
  // jobs would bury what else is said.
  if (FLAGS_minloglevel == google::GLOG_WARNING) {
    FLAGS_minloglevel = google::GLOG_ERROR;
  }
  BatchProgressReporter reporter;
  options.on_finished = [&reporter](const BatchProgress& progress) {
    reporter.Report(progress);
  };
  const BatchSummary summary = RunBatch(plan, options, communicator);
  if (!is_root) return kExitDone;
  reporter.End();
  PrintSummary(summary, options);
  return ExitStatusOf(summary.Worst());
}

}  // namespace

ExitStatus RunBatchCommand(const CommandLine& line) {
  return RunAsLaunched(
      [&line](Communicator* communicator) { return Run(line, communicator); });
}

}  // namespace alidade::internal
