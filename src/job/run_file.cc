#include "alidade/run_file.h"

#include <algorithm>
#include <utility>

#include "alidade/error.h"
#include "alidade/parameter_layout.h"
#include "src/common/files.h"
#include "src/common/names.h"
#include "src/common/number_text.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/job/arm_export.h"
#include "src/job/run_job.h"
#include "src/model/joint_draw.h"
#include "src/serialization/simulation_file.h"
#include "src/simulation/simulation.h"

namespace alidade {
namespace {

// Joint values are whole in a double, and so rounded to nothing.
constexpr int kNoRounding = -1;

void RequireOneOf(const char* key, const std::string& value,
                  const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  throw InputError({"", 0, 0, key}, internal::UnknownName(key, value, choices));
}

}  // namespace

PlanResult RunPlanFile(const std::string& path, int num_threads) {
  internal::PlanConfig config = internal::LoadPlan(path, num_threads);
  config.job.options.num_threads = num_threads;
  return internal::RunPlan(config, "");
}

MonteCarloResult RunMonteCarloFile(const std::string& path, int num_threads,
                                   const TrialProgress& progress) {
  const internal::JobConfig config = internal::LoadJob(path, num_threads);
  MonteCarloResult result = internal::WithFileInErrors(path, [&] {
    return RunMonteCarlo(config.arm, config.data, config.options,
                         config.montecarlo, progress);
  });
  result.title = config.title;
  return result;
}

SimulatedMeasurements RunSimulationFile(const std::string& path) {
  const internal::SimulationConfig config = internal::LoadSimulation(path);
  SimulatedMeasurements simulated;
  simulated.data = internal::Simulate(config);
  simulated.arm = config.arm;
  simulated.real =
      ParameterLayout(config.arm).WithValues(config.arm, config.true_values);
  simulated.sigma = config.noise_sigma;
  simulated.seed = config.seed;
  simulated.output = config.output;
  return simulated;
}

Dataset SimulatePositions(const Arm& real, const Eigen::MatrixXd& joint_values,
                          double sigma, std::uint64_t seed) {
  internal::SimulationConfig config;
  config.arm = real;
  config.true_values = ParameterLayout(real).Values(real);
  config.poses = internal::PosesFromFile{"", joint_values};
  config.noise_sigma = sigma;
  config.seed = seed;
  config.joint_decimals = kNoRounding;
  return internal::Simulate(config);
}

Eigen::MatrixXd DrawConfigurations(const Arm& arm, int count,
                                   std::uint64_t seed) {
  return internal::DrawJointValues(arm, count, seed);
}

ExportedArm ExportArm(const Arm& nominal, const Arm& real,
                      const std::string& format, const std::string& table,
                      const std::string& nominal_path) {
  RequireOneOf("format", format,
               {"dh", "mdh", "offsets", "ur", "urdf", "json"});
  RequireOneOf("table", table, {"csv", "yaml", "latex"});
  internal::ArmExport exported =
      internal::ExportArm({format, table, nominal_path}, nominal, real);
  return {std::move(exported.text), std::move(exported.lost), exported.cost};
}

void SaveDataset(const Dataset& data, const Arm& arm, const std::string& path) {
  for (const ObservationBlock& block : data.blocks) {
    if (HoldsPosition(block.kind)) continue;
    throw InputError({path, 0, 0, ""},
                     std::string("the data set has observations of kind \"") +
                         NameOf(block.kind) +
                         "\", expected positions and poses alone");
  }
  if (internal::IsNpy(path)) {
    internal::WriteFileAtomically(path, internal::FormatNpy(data, arm, true));
    return;
  }
  internal::WriteFileAtomically(path, [&](const internal::TextSink& sink) {
    internal::WriteDatasetText(data, arm, internal::kFewestDigits, true, {},
                               sink);
  });
}

}  // namespace alidade
