#include <iostream>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "src/calibration/calibration_task.h"
#include "src/cli/command.h"
#include "src/cli/progress.h"
#include "src/dataio/dataset_csv.h"
#include "src/report/report.h"
#include "src/serialization/job_config.h"

namespace alidade::internal {
namespace {

// The rules and ranks compare columns with each other: any sigma will do for a
// data set that states none.
constexpr double kAnySigma = kMillimetre;

JobConfig LoadJobOrPair(const CommandLine& line) {
  const std::vector<std::string>& files = line.files;
  if (files.size() == 1) return LoadJob(files.front(), line.threads);
  JobConfig config;
  config.arm = LoadArm(files[0]);
  DataFormat format;
  format.sigma = kAnySigma;
  LoadedData loaded = LoadData(files[1], config.arm, format,
                               &config.data.references, line.threads);
  config.data.training = std::move(loaded.data);
  config.rejected = std::move(loaded.rejected);
  return config;
}

}  // namespace

ExitStatus RunIdentify(const CommandLine& line) {
  JobConfig config = LoadJobOrPair(line);
  if (line.seed) config.options.identifiability.seed = *line.seed;
  LogReading(config.data, config.input_files, config.rejected.size());
  config.options.num_threads = line.threads;
  const IdentifiabilityResult result = AnalyzeTask(config);
  LogIdentifiability(result);
  std::cout << config.arm.name << ", " << config.data.training.num_poses()
            << " poses\n";
  if (line.files.size() > 1) {
    std::cout << "where the data state no standard deviation, 1 mm is taken: a "
                 "job states the instrument's\n";
  }
  std::cout << FormatIdentifiability(result);
  return kExitDone;
}

}  // namespace alidade::internal
