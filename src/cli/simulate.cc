#include <glog/logging.h>

#include <filesystem>
#include <iostream>

#include "src/cli/command.h"
#include "src/common/files.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/job/result_directory.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"

namespace alidade::internal {
namespace {

std::vector<std::string> Provenance(const SimulationConfig& config) {
  return {config.title,
          "simulated by alidade simulate " +
              std::filesystem::path(config.path).filename().string(),
          "arm: " + config.arm.name + "; seed: " + std::to_string(config.seed)};
}

// The name's ending says how; an array has no room for comments.
void Write(const SimulationConfig& config, const Dataset& data) {
  const bool with_sigmas = config.noise_sigma > 0.0;
  if (IsNpy(config.output)) {
    WriteFileAtomically(config.output,
                        FormatNpy(data, config.arm, with_sigmas));
    return;
  }
  WriteFileAtomically(config.output, [&](const TextSink& sink) {
    WriteDatasetText(data, config.arm, config.joint_decimals, with_sigmas,
                     Provenance(config), sink);
  });
}

}  // namespace

ExitStatus RunSimulate(const CommandLine& line) {
  SimulationConfig config = LoadSimulation(line.files.front());
  if (line.seed) config.seed = *line.seed;
  if (!line.out.empty()) config.output = line.out;
  CheckOutputFile(config.output, config.input_files);
  LOG(INFO) << "read " << config.arm.name << ", " << config.arm.num_joints()
            << " joints";
  const Dataset data = Simulate(config);
  LOG(INFO) << "simulated " << data.num_poses() << " poses with seed "
            << config.seed;
  const std::filesystem::path directory =
      std::filesystem::path(config.output).parent_path();
  if (!directory.empty()) MakeDirectories(directory.string());
  Write(config, data);
  std::cout << config.output << ": " << data.num_poses() << " poses\n";
  return kExitDone;
}

}  // namespace alidade::internal
