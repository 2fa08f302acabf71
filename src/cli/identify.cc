#include <iostream>
#include <utility>

#include "alidade/arm_file.h"
#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "src/calibration/calibration_task.h"
#include "src/cli/command.h"
#include "src/cli/progress.h"
#include "src/dataio/dataset_csv.h"
#include "src/model/joint_draw.h"
#include "src/report/report.h"
#include "src/serialization/config_file.h"
#include "src/serialization/job_config.h"
#include "src/serialization/ur_kinematics.h"
#include "src/serialization/yaml_reader.h"

namespace alidade::internal {
namespace {

// The rules and ranks compare columns with each other: any sigma will do for a
// data set that states none.
constexpr double kAnySigma = kMillimetre;

// Poses of an arm of which nothing was measured yet.
constexpr int kRandomPoses = 200;

bool IsArmAlone(const CommandLine& line) {
  return line.files.size() == 1 &&
         (IsUrKinematics(ReadYaml(line.files[0])) ||
          DetectFormat(line.files[0]) == FileFormat::kArm);
}

// What positions of the target at random poses would identify.
JobConfig ArmAlone(const CommandLine& line) {
  JobConfig config;
  config.arm = LoadArm(line.files[0]);
  const Eigen::MatrixXd joints =
      DrawJointValues(config.arm, kRandomPoses, line.seed.value_or(1));
  Eigen::Matrix3Xd points(3, kRandomPoses);
  for (int i = 0; i < kRandomPoses; ++i) {
    points.col(i) = TargetPose(config.arm, joints.col(i)).translation();
  }
  config.data.training =
      MakePositions(joints, points,
                    SharedMatrix::Repeated(Eigen::Vector3d::Constant(kAnySigma),
                                           kRandomPoses));
  config.options.identifiability.candidates = {true, true, true};
  return config;
}

JobConfig LoadJobOrPair(const CommandLine& line) {
  const std::vector<std::string>& files = line.files;
  if (IsArmAlone(line)) return ArmAlone(line);
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
            << (IsArmAlone(line) ? " random poses within the joint limits, "
                                   "the target's position measured; base and "
                                   "tool are identified too: a job or a data "
                                   "set says what was measured\n"
                                 : " poses\n");
  if (line.files.size() > 1) {
    std::cout << "where the data state no standard deviation, 1 mm is taken: a "
                 "job states the instrument's\n";
  }
  std::cout << FormatIdentifiability(result);
  return kExitDone;
}

}  // namespace alidade::internal
