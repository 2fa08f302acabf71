#include "alidade/correction.h"

#include <glog/logging.h>

#include <cstddef>
#include <limits>

#include "alidade/forward_kinematics.h"
#include "alidade/rotation.h"

namespace alidade {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

Poses PosesAt(const Arm& arm, const Eigen::MatrixXd& joint_values) {
  Poses poses;
  poses.reserve(static_cast<std::size_t>(joint_values.cols()));
  for (const auto& q : joint_values.colwise()) {
    poses.push_back(TargetPose(arm, q));
  }
  return poses;
}

// From the controller's joint values and the targets on.
void Finish(const CorrectionArms& arms, const Eigen::MatrixXd& asked,
            const CorrectionOptions& options, Correction* correction) {
  correction->asked_motors = MotorsFromJoints(arms.nominal, asked);
  const Eigen::MatrixXd in_real =
      JointsFromMotors(arms.real, correction->asked_motors);
  if (options.inverse) {
    correction->poses = PosesAt(arms.real, in_real);
    correction->solutions =
        SolvePoses(arms.nominal, correction->poses, asked, options.solver);
    correction->motors =
        MotorsFromJoints(arms.nominal, correction->solutions.joint_values);
  } else {
    correction->solutions =
        SolvePoses(arms.real, correction->targets, in_real, options.solver);
    correction->motors =
        MotorsFromJoints(arms.real, correction->solutions.joint_values);
    correction->poses = PosesAt(
        arms.nominal, JointsFromMotors(arms.nominal, correction->motors));
  }
  const Eigen::Index count = asked.cols();
  correction->shift.resize(count);
  correction->turn.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Isometry3d& from = correction->targets[i];
    const Eigen::Isometry3d& to = correction->poses[i];
    correction->shift[i] = (to.translation() - from.translation()).norm();
    const Eigen::Matrix3d turn = to.linear() * from.linear().transpose();
    correction->turn[i] = VectorFromRotation(turn).norm();
  }
}

}  // namespace

CorrectionArms MakeCorrectionArms(const Arm& nominal, const Arm& real,
                                  int target, ToolSource tool) {
  CHECK_EQ(nominal.num_joints(), real.num_joints());
  CorrectionArms arms{nominal, real};
  const Eigen::Vector3d load = MeanTargetOf(real);
  arms.nominal.targets = {nominal.targets[target]};
  arms.real.targets = arms.nominal.targets;
  if (tool == ToolSource::kCalibrated) {
    arms.real.targets = {real.targets[target]};
  }
  arms.real.instrument_from_base = nominal.instrument_from_base;
  if (real.errors.load_geometry.size() == 0) {
    arms.real.errors.payload.centre += load - MeanTargetOf(arms.real);
  }
  return arms;
}

Correction CorrectJoints(const CorrectionArms& arms,
                         const Eigen::MatrixXd& motors,
                         const CorrectionOptions& options) {
  const Eigen::MatrixXd asked = JointsFromMotors(arms.nominal, motors);
  Correction correction;
  correction.targets = PosesAt(arms.nominal, asked);
  correction.asked_status.assign(correction.targets.size(),
                                 PoseStatus::kReached);
  Finish(arms, asked, options, &correction);
  return correction;
}

Correction CorrectPoses(const CorrectionArms& arms, const Poses& poses,
                        const Eigen::MatrixXd& starts,
                        const CorrectionOptions& options) {
  PoseSolutions asked;
  if (starts.cols() > 0) {
    PoseSolverOptions solver = options.solver;
    solver.max_joint_change = std::numeric_limits<double>::infinity();
    asked = SolvePoses(arms.nominal, poses,
                       JointsFromMotors(arms.nominal, starts), solver);
  } else {
    asked = FindPoses(arms.nominal, poses, MiddleOfLimits(arms.nominal),
                      options.num_trials, options.seed, options.solver);
  }
  Correction correction;
  correction.targets = poses;
  correction.asked_status = asked.status;
  Finish(arms, asked.joint_values, options, &correction);
  return correction;
}

}  // namespace alidade
