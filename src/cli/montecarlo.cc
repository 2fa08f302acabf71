#include <glog/logging.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>

#include "alidade/monte_carlo.h"
#include "src/cli/command.h"
#include "src/cli/progress.h"
#include "src/common/files.h"
#include "src/common/format.h"
#include "src/job/result_directory.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

// "trial 2560 of 10000, 3120 a second, 2.4 s left".
TrialProgress ShowTrials(ProgressLine* progress) {
  const auto start = std::chrono::steady_clock::now();
  return [progress, start](int done, int wanted) {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
            .count();
    const double rate = done / seconds;
    char text[120];
    std::snprintf(text, sizeof text,
                  "trial %d of %d, %.0f a second, %.1f s left", done, wanted,
                  rate, (wanted - done) / rate);
    progress->Show(text);
  };
}

// What goes wrong with the job is said with its file, which the library does
// not know.
MonteCarloResult Study(const std::string& path, const JobConfig& config,
                       ProgressLine* progress) {
  MonteCarloResult result = WithFileInErrors(path, [&config, progress] {
    return alidade::RunMonteCarlo(config.arm, config.data, config.options,
                                  config.montecarlo, ShowTrials(progress));
  });
  result.title = config.title;
  return result;
}

}  // namespace

ExitStatus RunMonteCarlo(const CommandLine& line) {
  const std::string& path = line.files.front();
  ProgressLine progress;
  progress.Show("reading " + path);
  JobConfig config = LoadJob(path, line.threads);
  if (!line.out.empty()) {
    CheckResultDirectory(line.out, OutputKind::kMonteCarlo, config.input_files);
  }
  if (line.seed) config.montecarlo.seed = *line.seed;
  progress.Clear();
  LogReading(config.data, config.input_files, config.rejected.size());
  const MonteCarloResult result = Study(path, config, &progress);
  progress.Clear();
  LOG(INFO) << "simulated and calibrated " << result.trials.size() << " of "
            << result.trials_wanted << " times, " << result.failed
            << " without a usable solution, in "
            << FormatSignificant(result.time_s, 3) << " s";
  std::cout << result.title << "\n\n" << FormatMonteCarlo(result);
  if (!line.out.empty()) {
    PrintResults(WriteResultDirectory(line.out, MakeMonteCarloFiles(result)));
  }
  if (2 * result.failed > static_cast<int>(result.trials.size())) {
    PrintError(path +
               ": more than half of the simulated calibrations found "
               "no usable solution; `alidade calibrate` says why");
    return kExitNumerical;
  }
  return kExitDone;
}

}  // namespace alidade::internal
