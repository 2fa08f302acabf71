#include "alidade/measurement/holdout.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "alidade/base/random.h"

namespace alidade {
namespace {

// The configurations 0 .. count - 1 in an order drawn by the seed (Fisher and
// Yates).
std::vector<int> Shuffled(int count, std::uint64_t seed) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  Random random(seed, 0);
  for (int i = count - 1; i > 0; --i) {
    const double draw = random.Uniform(0.0, static_cast<double>(i + 1));
    std::swap(order[i], order[std::min(i, static_cast<int>(draw))]);
  }
  return order;
}

int CountGroups(const std::vector<int>& groups) {
  return groups.empty() ? 0
                        : 1 + *std::max_element(groups.begin(), groups.end());
}

HoldOut Split(const Dataset& data, const std::vector<int>& groups,
              const std::vector<char>& group_is_heldout) {
  std::vector<bool> is_heldout;
  for (const int group : groups) {
    is_heldout.push_back(group_is_heldout[group] != 0);
  }
  return HoldOutPoses(data, is_heldout);
}

// The first pose of the configuration that `pose` belongs to (a forest of
// pointers to earlier poses).
Eigen::Index FirstOf(std::vector<Eigen::Index>* first, Eigen::Index pose) {
  while ((*first)[pose] != pose)
    pose = (*first)[pose] = (*first)[(*first)[pose]];
  return pose;
}

// For every pose the first with the same joint values.
std::vector<Eigen::Index> FirstWithSameJoints(const Dataset& data) {
  const auto less = [&](Eigen::Index a, Eigen::Index b) {
    const auto x = data.joint_values.col(a);
    const auto y = data.joint_values.col(b);
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      if (x[j] != y[j]) return x[j] < y[j];
    }
    return false;
  };
  std::vector<Eigen::Index> order(data.num_poses());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), less);
  std::vector<Eigen::Index> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || less(order[i - 1], order[i]);
    first[order[i]] = is_new ? order[i] : first[order[i - 1]];
  }
  return first;
}

std::vector<int> Numbered(std::vector<Eigen::Index> first) {
  std::vector<int> groups(first.size());
  int count = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto pose = static_cast<Eigen::Index>(i);
    const Eigen::Index root = FirstOf(&first, pose);
    groups[i] = root == pose ? count++ : groups[root];
  }
  return groups;
}

// Poses of a difference belong together.
void JoinDifferences(const Dataset& data, std::vector<Eigen::Index>* first) {
  for (const ObservationBlock& block : data.blocks) {
    if (block.kind != MeasurementKind::kDifference) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      const Eigen::Index a = FirstOf(first, block.pose(i));
      const Eigen::Index b = FirstOf(first, block.seconds[i]);
      (*first)[std::max(a, b)] = std::min(a, b);
    }
  }
}

template <typename Entry>
void Gather(const std::vector<Entry>& from,
            const std::vector<Eigen::Index>& indices, std::vector<Entry>* to) {
  if (from.empty()) return;
  for (const Eigen::Index i : indices) to->push_back(from[i]);
}

void GatherColumns(const Eigen::MatrixXd& from,
                   const std::vector<Eigen::Index>& indices,
                   Eigen::MatrixXd* to) {
  to->resize(from.rows(), static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    to->col(static_cast<Eigen::Index>(i)) = from.col(indices[i]);
  }
}

// The observations at selected poses; new_pose: -1 for the others.
ObservationBlock SelectObservations(const ObservationBlock& block,
                                    const std::vector<Eigen::Index>& poses,
                                    const std::vector<int>& new_pose) {
  const bool has_poses = block.kind != MeasurementKind::kPointDistance;
  const bool is_difference = block.kind == MeasurementKind::kDifference;
  // Observation i stays that of pose i, unless it may go for its second pose.
  const bool is_of_each_pose =
      has_poses && block.poses.empty() && !is_difference;
  std::vector<Eigen::Index> chosen;
  if (is_of_each_pose) {
    chosen = poses;
  } else {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (has_poses && new_pose[block.pose(i)] < 0) continue;
      if (is_difference && new_pose[block.seconds[i]] < 0) continue;
      chosen.push_back(i);
    }
  }
  ObservationBlock selected = TakeObservations(block, chosen);
  if (!has_poses || is_of_each_pose) {
    selected.poses.clear();
  } else {
    for (int& pose : selected.poses) pose = new_pose[pose];
  }
  if (is_difference) {
    for (int& pose : selected.seconds) pose = new_pose[pose];
  }
  return selected;
}

}  // namespace

std::vector<int> GroupByJointValues(const Dataset& data) {
  return Numbered(FirstWithSameJoints(data));
}

std::vector<int> GroupByConfiguration(const Dataset& data) {
  std::vector<Eigen::Index> first = FirstWithSameJoints(data);
  JoinDifferences(data, &first);
  return Numbered(std::move(first));
}

ObservationBlock TakeObservations(const ObservationBlock& block,
                                  const std::vector<Eigen::Index>& indices) {
  ObservationBlock taken;
  taken.kind = block.kind;
  for (const Eigen::Index i : indices) taken.poses.push_back(block.pose(i));
  Gather(block.targets, indices, &taken.targets);
  Gather(block.references, indices, &taken.references);
  Gather(block.seconds, indices, &taken.seconds);
  Gather(block.whiteners, indices, &taken.whiteners);
  GatherColumns(block.measured, indices, &taken.measured);
  GatherColumns(block.sigmas, indices, &taken.sigmas);
  return taken;
}

Dataset SelectPoses(const Dataset& data,
                    const std::vector<Eigen::Index>& poses) {
  Dataset selected;
  selected.name = data.name;
  selected.files = data.files;
  GatherColumns(data.joint_values, poses, &selected.joint_values);
  Gather(data.sources, poses, &selected.sources);
  std::vector<int> new_pose(data.num_poses(), -1);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    new_pose[poses[i]] = static_cast<int>(i);
  }
  for (const ObservationBlock& block : data.blocks) {
    selected.blocks.push_back(SelectObservations(block, poses, new_pose));
  }
  return selected;
}

HoldOut HoldOutPoses(const Dataset& data, const std::vector<bool>& is_heldout) {
  std::vector<Eigen::Index> train;
  std::vector<Eigen::Index> heldout;
  for (std::size_t pose = 0; pose < is_heldout.size(); ++pose) {
    (is_heldout[pose] ? heldout : train)
        .push_back(static_cast<Eigen::Index>(pose));
  }
  HoldOut split{SelectPoses(data, train), SelectPoses(data, heldout)};
  std::vector<ObservationBlock>& blocks = split.heldout.blocks;
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(),
                              [](const ObservationBlock& block) {
                                return block.kind ==
                                       MeasurementKind::kPointDistance;
                              }),
               blocks.end());
  return split;
}

HoldOut HoldOutFraction(const Dataset& data, double fraction,
                        std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  const int count = CountGroups(groups);
  const auto num_heldout = static_cast<int>(std::lround(fraction * count));
  const std::vector<int> order = Shuffled(count, seed);
  std::vector<char> is_heldout(count, 0);
  for (int i = 0; i < num_heldout; ++i) is_heldout[order[i]] = 1;
  return Split(data, groups, is_heldout);
}

HoldOut HoldOutFold(const Dataset& data, int folds, int k, std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  const int count = CountGroups(groups);
  const std::vector<int> order = Shuffled(count, seed);
  std::vector<char> is_heldout(count, 0);
  for (int i = k; i < count; i += folds) is_heldout[order[i]] = 1;
  return Split(data, groups, is_heldout);
}

}  // namespace alidade
