#include <iostream>
#include <optional>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/dataio/dataset_csv.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/plan_file.h"
#include "src/serialization/simulation_file.h"

namespace alidade::internal {
namespace {

class Checker {
 public:
  explicit Checker(int num_threads) : num_threads_(num_threads) {}

  /// One line about the file. @throws InputError.
  std::string Check(const std::string& path) {
    if (IsDataFile(path)) return CheckData(path);
    switch (DetectFormat(path)) {
      case FileFormat::kArm:
        arm_ = LoadArm(path);
        return "arm, " + std::to_string(arm_->num_joints()) + " joints";
      case FileFormat::kDeviations:
        LoadDeviations(path, RequireArm(path));
        return "deviations of " + arm_->name;
      case FileFormat::kSimulation:
        LoadSimulation(path);
        return "simulation";
      case FileFormat::kPlan:
        LoadPlan(path, num_threads_);
        return "plan";
      case FileFormat::kJob:
        return CheckJob(path);
    }
    return "";
  }

 private:
  std::string CheckJob(const std::string& path) const {
    const JobConfig job = LoadJob(path, num_threads_);
    std::string said =
        "job, " + std::to_string(job.data.training.num_poses()) + " poses";
    if (job.data.validation) {
      said += " and " + std::to_string(job.data.validation->num_poses()) +
              " validation poses";
    }
    return said;
  }

  std::string CheckData(const std::string& path) {
    DataFormat format;
    format.sigma = kMillimetre;
    References references;
    const Dataset data =
        LoadData(path, RequireArm(path), format, &references, num_threads_)
            .data;
    return "data set, " + std::to_string(data.num_poses()) + " poses of " +
           arm_->name;
  }

  const Arm& RequireArm(const std::string& path) const {
    if (arm_) return *arm_;
    throw InputError({path, 0, 0, ""},
                     "a table of measurements, whose columns depend on the "
                     "arm: name that before it, as in 'alidade check "
                     "robots/ur10e " +
                         path +
                         "' ('alidade robots' lists arms); what another "
                         "program wrote 'alidade import' reads");
  }

  const int num_threads_;
  std::optional<Arm> arm_;
};

}  // namespace

ExitStatus RunCheck(const CommandLine& line) {
  Checker checker(line.threads);
  ExitStatus status = kExitDone;
  for (const std::string& path : line.files) {
    try {
      // Only whole lines: errors go elsewhere.
      const std::string said = checker.Check(path);
      std::cout << path << ": " << said << "\n";
    } catch (const InputError& error) {
      PrintError(error.what());
      status = kExitBadInput;
    }
  }
  return status;
}

}  // namespace alidade::internal
