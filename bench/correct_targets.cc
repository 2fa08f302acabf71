// Random reachable targets of the nominal arm, brought to arms with deviations
// and all error terms: how many are reached, how exactly, and how many a second
// (docs/robot.md).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "alidade/arm_file.h"
#include "alidade/forward_kinematics.h"
#include "alidade/inverse_kinematics.h"
#include "alidade/rotation.h"
#include "bench/study_main.h"
#include "src/common/random.h"
#include "src/model/joint_draw.h"
#include "tests/support/error_term_kinematics.h"

namespace alidade::internal::bench {
namespace {

Arm RobotArm(const std::string& path) {
  Arm arm = LoadArm(path);
  for (Joint& joint : arm.joints) {
    if (HasLimits(joint)) continue;
    joint.upper = joint.type == JointType::kRevolute ? 2.9 : 0.5;
    joint.lower = -joint.upper;
  }
  arm.last_from_target().translation() += Eigen::Vector3d(0.02, -0.01, 0.08);
  return arm;
}

struct Row {
  std::string name;
  int status[4] = {};
  int num_wrong = 0;
  double position = 0.0;
  double rotation = 0.0;
  double steps = 0.0;
  double rate = 0.0;
  double rigid_rate = 0.0;
};

double RateOf(const Arm& arm, const std::vector<Eigen::Isometry3d>& targets,
              const Eigen::MatrixXd& starts, PoseSolutions* found) {
  // Of the processor, which others may use too.
  const std::clock_t begin = std::clock();
  *found = SolvePoses(arm, targets, starts);
  const double time =
      static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return static_cast<double>(targets.size()) / time;
}

Row Measure(const std::string& path, int count) {
  const Arm nominal = RobotArm(path);
  Random random(1);
  const Arm real = testing::WithRandomErrors(nominal, &random);
  Arm rigid = real;
  rigid.errors = {};
  const Eigen::MatrixXd starts = DrawJointValues(nominal, count, 1);
  std::vector<Eigen::Isometry3d> targets;
  for (const auto& q : starts.colwise()) {
    targets.push_back(TargetPose(nominal, q));
  }
  Row row;
  row.name = nominal.name;
  PoseSolutions found;
  row.rigid_rate = RateOf(rigid, targets, starts, &found);
  row.rate = RateOf(real, targets, starts, &found);
  const testing::ErrorTermKinematics oracle(real);
  for (int i = 0; i < count; ++i) {
    ++row.status[static_cast<int>(found.status[i])];
    if (found.status[i] != PoseStatus::kReached) continue;
    row.steps += found.iterations[i];
    const Eigen::Matrix4d pose =
        oracle.TargetFrame(found.joint_values.col(i)).cast<double>();
    const double position =
        (pose.topRightCorner<3, 1>() - targets[i].translation()).norm();
    const Eigen::Matrix3d turn =
        targets[i].linear() * pose.topLeftCorner<3, 3>().transpose();
    const double rotation =
        nominal.num_joints() < 6 ? 0.0 : VectorFromRotation(turn).norm();
    row.num_wrong += position > 1e-9 || rotation > 1e-7;
    row.position = std::max(row.position, position);
    row.rotation = std::max(row.rotation, rotation);
  }
  row.steps /= std::max(1, row.status[0]);
  return row;
}

void Print(const Row& row) {
  std::printf(
      "| %s | %d | %d | %d | %d | %d | %.1e | %.1e | %.1f | %.0f | %.0f |\n",
      row.name.c_str(), row.status[0], row.status[1], row.status[2],
      row.status[3], row.num_wrong, row.position * 1e3, row.rotation, row.steps,
      row.rate, row.rigid_rate);
}

}  // namespace
}  // namespace alidade::internal::bench

int main(int argc, char** argv) {
  using namespace alidade::internal::bench;
  return StudyMain(
      argc, argv, "correct_targets COUNT ARM.yaml...",
      [](const std::vector<std::string>& arguments) {
        if (arguments.size() < 2) return false;
        std::printf(
            "| arm | reached | out of reach | joint limit | branch "
            "change | wrong | largest error mm | rad | steps | per "
            "second | rigid, per second |\n"
            "|---|---|---|---|---|---|---|---|---|---|---|\n");
        const int count = std::atoi(arguments[0].c_str());
        for (std::size_t i = 1; i < arguments.size(); ++i) {
          Print(Measure(arguments[i], count));
        }
        return true;
      });
}
