#include "alidade/error.h"
#include "alidade/forward_kinematics.h"
#include "src/cli/command.h"
#include "src/cli/targets.h"
#include "src/common/parallel.h"
#include "src/job/arm_source.h"

namespace alidade::internal {

ExitStatus RunFk(const CommandLine& line) {
  const Arm arm = LoadArmOrResult(line.files[0]);
  const int target = TargetFlag(line, arm);
  const auto rotation = RotationFlag(line);
  const TargetTable table =
      ReadTargets(line.files[1], arm, rotation.value_or(RotationConvention()));
  if (!table.has_joints) {
    throw InputError({table.path, 0, 0, ""},
                     "no joint values, expected columns q1_deg ...");
  }
  const Eigen::MatrixXd joints = JointsFromMotors(arm, table.motors);
  std::vector<Eigen::Isometry3d> poses(static_cast<std::size_t>(joints.cols()));
  ParallelFor(line.threads, joints.cols(), 1024,
              [&](std::int64_t begin, std::int64_t end) {
                for (std::int64_t i = begin; i < end; ++i) {
                  poses[i] = TargetPose(arm, joints.col(i), target);
                }
              });
  // Where the table has poses, those of the arm stand beside them.
  const std::string prefix = !table.has_positions ? "" : "fk_";
  PoseFormat format = table.format;
  if (rotation || format.form == OrientationForm::kNone) {
    format.form =
        rotation ? OrientationForm::kAngles : OrientationForm::kVector;
    if (rotation) format.rotation = *rotation;
  }
  WriteTable(line, WithColumns(table, PoseColumns(prefix, poses, format)),
             line.files);
  return kExitDone;
}

}  // namespace alidade::internal
