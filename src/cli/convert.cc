#include <filesystem>
#include <iostream>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "src/cli/command.h"
#include "src/common/files.h"
#include "src/common/text.h"
#include "src/dataio/dataset_csv.h"
#include "src/dataio/dataset_npy.h"
#include "src/job/result_directory.h"
#include "src/model/motors.h"

namespace alidade::internal {
namespace {

namespace fs = std::filesystem;

void CheckNames(const CommandLine& line) {
  if (line.arm.empty()) {
    throw InputError(
        {},
        "convert: --arm=ARM.yaml is missing: how many joints there are, and "
        "which slide, is the arm's; 'alidade convert --help' says more");
  }
  const std::string& from = line.files[0];
  const std::string& to = line.files[1];
  for (const std::string& path : line.files) {
    const bool is_text = fs::path(path).extension() == ".csv" || &path == &from;
    if (IsNpy(path) || (IsDataFile(path) && is_text)) continue;
    throw InputError({path, 0, 0, ""},
                     "expected a name that ends in .csv or .npy");
  }
  if (IsNpy(from) == IsNpy(to)) {
    throw InputError(
        {to, 0, 0, ""},
        "the same format as " + from + ", expected .csv and .npy, one of each");
  }
}

// Columns hold what the motors say and one target's positions; what the arm
// makes of them is for those who read the file with it.
Arm WithoutMotorMap(Arm arm) {
  const std::vector<Dimension> motors = MotorDimensions(arm);
  arm.joints.resize(motors.size());
  for (std::size_t j = 0; j < motors.size(); ++j) {
    arm.joints[j].type = motors[j] == Dimension::kAngle ? JointType::kRevolute
                                                        : JointType::kPrismatic;
  }
  arm.joints_from_motors.resize(0, 0);
  arm.motor_offsets.resize(0);
  return arm;
}

LoadedData Load(const std::string& path, const Arm& arm, int num_threads) {
  DataFormat format;
  format.sigma = kUnstatedSigma;
  if (arm.num_targets() > 1) format.target = arm.targets.front().name;
  References references;
  try {
    return LoadData(path, arm, format, &references, num_threads);
  } catch (const InputError& error) {
    if (error.location().key != "target" || format.target.empty()) throw;
    throw InputError(error.location(),
                     "rows name their targets, which arrays of numbers cannot: "
                     "expected a file for each target without this column, and "
                     "`target` in the job's `data`");
  }
}

[[noreturn]] void Refuse(const std::string& path, const std::string& what) {
  throw InputError({path, 0, 0, ""},
                   what +
                       " are not converted, expected positions or "
                       "orientations alone: jobs read the file as it is");
}

void CheckKinds(const std::string& path, const LoadedData& loaded) {
  for (const ObservationBlock& block : loaded.data.blocks) {
    if (!HoldsPosition(block.kind)) {
      Refuse(path, std::string("measurements of the kind \"") +
                       NameOf(block.kind) + "\"");
    }
    if (!block.whiteners.empty()) Refuse(path, "covariances");
  }
  if (!loaded.sets.empty()) Refuse(path, "the texts of the column \"set\"");
}

}  // namespace

ExitStatus RunConvert(const CommandLine& line) {
  CheckNames(line);
  const std::string& from = line.files[0];
  const std::string& to = line.files[1];
  std::vector<std::string> inputs = {from, line.arm};
  Arm arm = WithoutMotorMap(LoadArm(line.arm, &inputs));
  CheckOutputFile(to, inputs);
  const LoadedData loaded = Load(from, arm, line.threads);
  CheckKinds(from, loaded);
  arm.targets.resize(1);
  if (IsNpy(to)) {
    WriteFileAtomically(to, FormatNpy(loaded.data, arm, true));
  } else {
    WriteFileAtomically(to, [&](const TextSink& sink) {
      WriteDatasetText(
          loaded.data, arm, kFewestDigits, true,
          {"converted from " + std::filesystem::path(from).filename().string()},
          sink);
    });
  }
  std::cout << to << ": " << loaded.data.num_poses() << " poses";
  if (!loaded.rejected.empty()) {
    std::cout << ", without " << loaded.rejected.size()
              << " rows that measure nothing";
  }
  std::cout << "\n";
  return kExitDone;
}

}  // namespace alidade::internal
