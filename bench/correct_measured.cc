// Corrections on measured data: what the real arm would miss each target by,
// where its joint values are corrected by a calibration that has not seen them
// (docs/robot.md).
//
// Usage: correct_measured SOURCE_DIRECTORY [SET...]
// ALIDADE_DATA names the folder of the data.

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "alidade/correction.h"
#include "alidade/forward_kinematics.h"
#include "alidade/units.h"
#include "bench/study_main.h"
#include "src/job/run_job.h"
#include "src/kernel/holdout.h"
#include "src/serialization/job_config.h"

namespace alidade::internal::bench {
namespace {

constexpr double kValidation = 0.3;
constexpr std::uint64_t kSeed = 1;

// The controller's arm where the calibrated one stands, so that its poses are
// in the instrument's frame.
Arm WithFramesOf(Arm arm, const Arm& frames) {
  arm.instrument_from_base = frames.instrument_from_base;
  arm.targets = frames.targets;
  return arm;
}

struct Row {
  int poses = 0;
  int reached = 0;
  double asked = 0.0;       // error of the nominal arm: not corrected
  double validation = 0.0;  // measured - model at q
  double corrected = 0.0;   // measured + model(q') - model(q) - target
};

// Adds the positions of one block.
void AddBlock(const CalibrationResult& result, const Arm& nominal,
              const Dataset& data, const ObservationBlock& block, Row* row) {
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    if (!block.sigmas.col(i).head(3).allFinite()) continue;
    const int target = block.target(i);
    CorrectionArms arms = {nominal, result.arm};
    for (Arm* arm : {&arms.nominal, &arms.real}) {
      arm->targets = {result.arm.targets[target]};
    }
    const Eigen::VectorXd q = data.joint_values.col(block.pose(i));
    const Correction correction =
        CorrectJoints(arms, MotorsFromJoints(nominal, q));
    ++row->poses;
    if (!correction.IsReached(0)) continue;
    ++row->reached;
    const Eigen::VectorXd corrected =
        JointsFromMotors(arms.real, correction.motors);
    const Eigen::Vector3d asked = correction.targets[0].translation();
    const Eigen::Vector3d measured = block.measured.col(i).head(3);
    const Eigen::Vector3d model = TargetPose(arms.real, q).translation();
    const Eigen::Vector3d moved =
        TargetPose(arms.real, corrected).translation();
    row->asked += (measured - asked).norm();
    row->validation += (measured - model).norm();
    row->corrected += (measured + moved - model - asked).norm();
  }
}

Row Measure(const std::string& path) {
  JobConfig job = LoadWholeJob(path);
  const Arm arm = job.arm;
  HoldOut split = HoldOutFraction(job.data.training, kValidation, kSeed);
  const Dataset validation = split.validation;
  job.data.training = std::move(split.train);
  job.data.validation = std::move(split.validation);
  job.options.errors.selection = ErrorTermSelection::kAuto;
  const CalibrationResult result = RunJob(std::move(job), "correct_measured");
  const Arm nominal = WithFramesOf(arm, result.arm);
  Row row;
  for (const ObservationBlock& block : validation.blocks) {
    if (HoldsPosition(block.kind)) {
      AddBlock(result, nominal, validation, block, &row);
    }
  }
  return row;
}

bool Run(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return false;
  std::vector<std::string> names(arguments.begin() + 1, arguments.end());
  if (names.empty()) {
    names = {"ur10_B",    "irb120", "panda_left", "panda_right",
             "panda_top", "rokae",  "column",     "ur10_A"};
  }
  std::printf(
      "| set | validation poses | reached | not corrected [mm] | validation "
      "error [mm] | corrected [mm] | ratio |\n|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const Row row =
        Measure(arguments[0] + "/configs/real_arms/" + name + ".yaml");
    const double unit = std::max(1, row.reached) * kMillimetre;
    std::printf("| `%s` | %d | %d | %.3f | %.4f | %.4f | %.5f |\n",
                name.c_str(), row.poses, row.reached, row.asked / unit,
                row.validation / unit, row.corrected / unit,
                row.corrected / row.validation);
    std::fflush(stdout);
  }
  return true;
}

}  // namespace
}  // namespace alidade::internal::bench

int main(int argc, char** argv) {
  return alidade::internal::bench::StudyMain(
      argc, argv, "correct_measured SOURCE_DIRECTORY [SET...]",
      alidade::internal::bench::Run);
}
