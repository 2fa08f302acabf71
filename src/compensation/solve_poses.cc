#include <glog/logging.h>

#include <cmath>

#include "alidade/inverse_kinematics.h"
#include "src/common/parallel.h"
#include "src/common/random.h"
#include "src/compensation/pose_solver.h"
#include "src/model/joint_draw.h"
#include "src/model/motors.h"

namespace alidade {
namespace {

// Targets that a thread takes at a time.
constexpr std::int64_t kBlock = 256;

PoseSolutions MakeSolutions(const Arm& arm, std::size_t count) {
  const auto size = static_cast<Eigen::Index>(count);
  PoseSolutions solutions;
  solutions.joint_values.resize(arm.num_joints(), size);
  solutions.status.resize(count);
  solutions.position_error.resize(size);
  solutions.rotation_error.resize(size);
  solutions.iterations.resize(count);
  return solutions;
}

void Keep(const internal::PoseSolution& solution,
          const Eigen::VectorXd& joint_values, Eigen::Index i,
          PoseSolutions* solutions) {
  solutions->joint_values.col(i) = joint_values;
  solutions->status[i] = solution.status;
  solutions->position_error[i] = solution.position_error;
  solutions->rotation_error[i] = solution.rotation_error;
  solutions->iterations[i] = solution.iterations;
}

}  // namespace

const char* ToString(PoseStatus status) {
  switch (status) {
    case PoseStatus::kReached:
      return "reached";
    case PoseStatus::kOutOfReach:
      return "out of reach";
    case PoseStatus::kLimit:
      return "joint limit";
    case PoseStatus::kBranchChange:
      break;
  }
  return "branch change";
}

PoseSolutions SolvePoses(const Arm& arm,
                         const std::vector<Eigen::Isometry3d>& targets,
                         const Eigen::MatrixXd& starts,
                         const PoseSolverOptions& options) {
  internal::RequireFreeJoints(arm);
  CHECK_EQ(starts.rows(), arm.num_joints());
  CHECK_EQ(starts.cols(), static_cast<Eigen::Index>(targets.size()));
  PoseSolutions solutions = MakeSolutions(arm, targets.size());
  internal::ParallelFor(options.num_threads, starts.cols(), kBlock,
                        [&](std::int64_t begin, std::int64_t end) {
                          internal::PoseSolver solver(arm, options);
                          Eigen::VectorXd joint_values(arm.num_joints());
                          for (std::int64_t i = begin; i < end; ++i) {
                            joint_values = starts.col(i);
                            const auto solution =
                                solver.Solve(targets[i], &joint_values);
                            Keep(solution, joint_values, i, &solutions);
                          }
                        });
  return solutions;
}

PoseSolutions FindPoses(const Arm& arm,
                        const std::vector<Eigen::Isometry3d>& targets,
                        const Eigen::VectorXd& start, int num_trials,
                        std::uint64_t seed, const PoseSolverOptions& options) {
  internal::RequireFreeJoints(arm);
  CHECK_EQ(start.size(), arm.num_joints());
  PoseSolverOptions free = options;
  free.max_joint_change = std::numeric_limits<double>::infinity();
  internal::PoseSolver solver(arm, free);
  PoseSolutions solutions = MakeSolutions(arm, targets.size());
  Eigen::VectorXd from = start;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    internal::Random random(seed, i);
    Eigen::VectorXd best = from;
    internal::PoseSolution answer = solver.Solve(targets[i], &best);
    for (int k = 0; k < num_trials; ++k) {
      if (answer.status == PoseStatus::kReached) break;
      Eigen::VectorXd trial(arm.num_joints());
      for (int j = 0; j < arm.num_joints(); ++j) {
        trial[j] = internal::DrawJointValue(arm, j, &random);
      }
      const internal::PoseSolution other = solver.Solve(targets[i], &trial);
      if (other.status != PoseStatus::kReached &&
          other.position_error >= answer.position_error) {
        continue;
      }
      answer = other;
      best = trial;
    }
    Keep(answer, best, static_cast<Eigen::Index>(i), &solutions);
    if (answer.status == PoseStatus::kReached) from = best;
  }
  return solutions;
}

Eigen::VectorXd MiddleOfLimits(const Arm& arm) {
  Eigen::VectorXd middle = Eigen::VectorXd::Zero(arm.num_joints());
  for (int j = 0; j < arm.num_joints(); ++j) {
    const Joint& joint = arm.joints[j];
    if (HasLimits(joint)) middle[j] = 0.5 * (joint.lower + joint.upper);
  }
  return middle;
}

}  // namespace alidade
