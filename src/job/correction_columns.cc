#include "src/job/correction_columns.h"

#include <algorithm>
#include <cstddef>

namespace alidade::internal {
namespace {

void CopyTarget(const Correction& from, Eigen::Index k, Eigen::Index i,
                Correction* to) {
  to->targets[i] = from.targets[k];
  to->asked_motors.col(i) = from.asked_motors.col(k);
  to->asked_status[i] = from.asked_status[k];
  to->motors.col(i) = from.motors.col(k);
  to->poses[i] = from.poses[k];
  const PoseSolutions& solutions = from.solutions;
  to->solutions.joint_values.col(i) = solutions.joint_values.col(k);
  to->solutions.status[i] = solutions.status[k];
  to->solutions.position_error[i] = solutions.position_error[k];
  to->solutions.rotation_error[i] = solutions.rotation_error[k];
  to->solutions.iterations[i] = solutions.iterations[k];
  to->shift[i] = from.shift[k];
  to->turn[i] = from.turn[k];
}

}  // namespace

Correction EmptyCorrection(Eigen::Index count, int num_joints) {
  Correction all;
  const auto size = static_cast<std::size_t>(count);
  all.asked_motors.resize(num_joints, count);
  all.motors.resize(num_joints, count);
  all.solutions.joint_values.resize(num_joints, count);
  all.solutions.position_error.resize(count);
  all.solutions.rotation_error.resize(count);
  all.shift.resize(count);
  all.turn.resize(count);
  all.targets.resize(size);
  all.poses.resize(size);
  all.asked_status.resize(size);
  all.solutions.status.resize(size);
  all.solutions.iterations.resize(size);
  return all;
}

void PutCorrection(const Correction& one, Eigen::Index i, Correction* all) {
  CopyTarget(one, 0, i, all);
}

Correction KeptCorrections(const Correction& all,
                           const std::vector<bool>& is_kept) {
  const auto count = std::count(is_kept.begin(), is_kept.end(), true);
  Correction kept = EmptyCorrection(count, static_cast<int>(all.motors.rows()));
  Eigen::Index next = 0;
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    if (!is_kept[i]) continue;
    CopyTarget(all, static_cast<Eigen::Index>(i), next++, &kept);
  }
  return kept;
}

}  // namespace alidade::internal
