#include <algorithm>

#include "alidade/error.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/units.h"
#include "src/cli/command.h"
#include "src/cli/targets.h"
#include "src/job/arm_source.h"

namespace alidade::internal {
namespace {

constexpr int kTrials = 200;

PoseSolutions Solve(const CommandLine& line, const Arm& arm,
                    const TargetTable& table) {
  PoseSolverOptions options;
  options.num_threads = line.threads;
  options.target = TargetFlag(line, arm);
  if (table.format.form == OrientationForm::kNone) {
    options.task = PoseTask::kPosition;
  }
  if (table.has_joints) {
    options.max_joint_change = std::numeric_limits<double>::infinity();
    return SolvePoses(arm, table.poses, JointsFromMotors(arm, table.motors),
                      options);
  }
  return FindPoses(arm, table.poses, MiddleOfLimits(arm), kTrials,
                   line.seed.value_or(kDefaultSeed), options);
}

}  // namespace

ExitStatus RunIk(const CommandLine& line) {
  const Arm arm = LoadArmOrResult(line.files[0]);
  const TargetTable table = ReadTargets(line.files[1], arm, RotationFlag(line));
  if (!table.has_positions) {
    throw InputError({table.path, 0, 0, ""},
                     "no positions, expected columns x_mm, y_mm, z_mm");
  }
  const PoseSolutions found = Solve(line, arm, table);
  const std::string prefix = table.has_joints ? "ik_" : "";
  std::vector<AddedColumn> columns =
      MotorColumns(prefix, arm, MotorsFromJoints(arm, found.joint_values));
  columns.push_back(
      NumberColumn("remaining_mm", found.position_error, kMillimetre, 9));
  if (table.format.form != OrientationForm::kNone) {
    columns.push_back(
        NumberColumn("remaining_deg", found.rotation_error, kDegree, 9));
  }
  AddedColumn status{"status", {}};
  for (const PoseStatus s : found.status) status.cells.push_back(ToString(s));
  columns.push_back(std::move(status));
  WriteTable(line, WithColumns(table, columns), line.files);
  return kExitDone;
}

}  // namespace alidade::internal
