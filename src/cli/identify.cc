#include <iostream>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/units.h"
#include "alidade/batch/job.h"
#include "alidade/batch/simulate.h"
#include "alidade/io/arm_file.h"
#include "alidade/io/dataset_csv.h"
#include "alidade/report/report.h"
#include "src/cli/command.h"
#include "src/cli/steps.h"

namespace alidade {
namespace {

// The rules and ranks compare columns with each other: any sigma will do for a
// data set that states none.
constexpr double kAnySigma = kMillimetre;

JobConfig LoadJobOrPair(const CommandLine& line) {
  const std::vector<std::string>& files = line.files;
  if (files.size() == 1) return ReadJob(files.front(), line.threads);
  JobConfig config;
  config.arm = LoadArm(files[0]);
  DataFormat format;
  format.sigma = kAnySigma;
  LoadedData loaded =
      LoadData(files[1], config.arm, format, &config.references, line.threads);
  config.data = std::move(loaded.data);
  config.rejected = std::move(loaded.rejected);
  return config;
}

}  // namespace

ExitStatus RunIdentify(const CommandLine& line) {
  JobConfig config = LoadJobOrPair(line);
  if (line.seed) config.identifiability.seed = *line.seed;
  LogReading(config);
  const IdentifiabilityResult result = IdentifyJob(config, line.threads);
  LogIdentifiability(result);
  std::cout << config.arm.name << ", " << config.data.num_poses() << " poses\n";
  if (line.files.size() > 1) {
    std::cout << "where the data state no standard deviation, 1 mm is taken: a "
                 "job states the instrument's\n";
  }
  std::cout << FormatIdentifiability(result);
  return kExitDone;
}

}  // namespace alidade
