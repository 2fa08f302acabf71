#include "alidade/batch/simulate.h"

#include <filesystem>
#include <iostream>

#include "alidade/batch/result_directory.h"
#include "alidade/io/dataset_csv.h"
#include "alidade/io/files.h"
#include "alidade/io/job_file.h"
#include "src/cli/command.h"

namespace alidade {
namespace {

std::vector<std::string> Provenance(const SimulationConfig& config) {
  return {config.title,
          "simulated by alidade simulate " +
              std::filesystem::path(config.path).filename().string(),
          "arm: " + config.arm.name + "; seed: " + std::to_string(config.seed)};
}

}  // namespace

ExitStatus RunSimulate(const CommandLine& line) {
  SimulationConfig config = LoadSimulation(line.files.front());
  if (line.seed) config.seed = *line.seed;
  if (!line.out.empty()) config.output = line.out;
  CheckOutputFile(config.output, config.input_files);
  const Dataset data = Simulate(config);
  const std::filesystem::path directory =
      std::filesystem::path(config.output).parent_path();
  if (!directory.empty()) MakeDirectories(directory.string());
  WriteFileAtomically(
      config.output,
      FormatDataset(data, config.arm, config.joint_decimals,
                    config.noise_sigma > 0.0, Provenance(config)));
  std::cout << config.output << ": " << data.num_poses() << " poses\n";
  return kExitDone;
}

}  // namespace alidade
