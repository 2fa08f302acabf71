#include "src/kernel/holdout.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "src/common/random.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
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

// The first pose of the configuration that `pose` belongs to (a forest of
// pointers to earlier poses).
Eigen::Index FirstOf(std::vector<Eigen::Index>* first, Eigen::Index pose) {
  while ((*first)[pose] != pose) {
    pose = (*first)[pose] = (*first)[(*first)[pose]];
  }
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

template <typename List>
void Gather(const List& from, const std::vector<Eigen::Index>& indices,
            List* to) {
  if (from.empty()) return;
  for (const Eigen::Index i : indices) to->push_back(from[i]);
}

SharedMatrix GatherColumns(const SharedMatrix& from,
                           const std::vector<Eigen::Index>& indices) {
  MatrixBuilder columns(from.rows(), static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    columns.map().col(static_cast<Eigen::Index>(i)) = from.col(indices[i]);
  }
  return columns.Freeze();
}

// Observation i stays that of pose i, unless it may go for its second pose.
bool IsOfEachPose(const ObservationBlock& block) {
  return block.size() > 0 && block.poses.empty() &&
         block.kind != MeasurementKind::kPointDistance &&
         block.kind != MeasurementKind::kDifference;
}

// Those at selected poses, in ascending order where these are; new_pose: -1 for
// poses that are not.
std::vector<Eigen::Index> ChooseObservations(
    const ObservationBlock& block, const std::vector<Eigen::Index>& poses,
    const std::vector<int>& new_pose) {
  if (IsOfEachPose(block)) return poses;
  const bool has_poses = block.kind != MeasurementKind::kPointDistance;
  const bool is_difference = block.kind == MeasurementKind::kDifference;
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    if (has_poses && new_pose[block.pose(i)] < 0) continue;
    if (is_difference && new_pose[block.seconds[i]] < 0) continue;
    chosen.push_back(i);
  }
  return chosen;
}

ObservationBlock SelectObservations(const ObservationBlock& block,
                                    const std::vector<Eigen::Index>& chosen,
                                    const std::vector<int>& new_pose) {
  ObservationBlock selected = TakeObservations(block, chosen);
  if (IsOfEachPose(block) || block.kind == MeasurementKind::kPointDistance) {
    selected.poses.clear();
  } else {
    for (int& pose : selected.poses) pose = new_pose[pose];
  }
  if (block.kind == MeasurementKind::kDifference) {
    for (int& pose : selected.seconds) pose = new_pose[pose];
  }
  return selected;
}

// What is left of the shards: poses in ascending order stay in theirs.
void SelectShards(const std::vector<Shard>& from,
                  const std::vector<Eigen::Index>& poses,
                  std::vector<Shard>* to) {
  if (!std::is_sorted(poses.begin(), poses.end())) return;
  for (const Shard& shard : from) {
    const auto first =
        std::lower_bound(poses.begin(), poses.end(), shard.first_pose);
    to->emplace_back();
    to->back().first_pose = first - poses.begin();
  }
}

struct PosePair {
  int pose = 0;
  int second = 0;
};

// Joint values and differences of all poses, which determine the
// configurations; on the root.
Dataset ConfigurationsOf(Communicator* communicator, const Dataset& data) {
  Dataset all;
  all.joint_values = PosesInOrder(communicator, data, data.joint_values);
  const auto first = static_cast<int>(data.partition->first_pose);
  std::vector<std::vector<PosePair>> pairs(data.blocks.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const ObservationBlock& block = data.blocks[k];
    if (block.kind != MeasurementKind::kDifference) continue;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      pairs[k].push_back({first + block.pose(i), first + block.seconds[i]});
    }
  }
  ObservationBlock differences;
  differences.kind = MeasurementKind::kDifference;
  for (const auto& [pose, second] :
       InOrder(communicator, data, std::move(pairs))) {
    differences.poses.push_back(pose);
    differences.seconds.push_back(second);
  }
  const auto count = static_cast<Eigen::Index>(differences.poses.size());
  differences.measured = Eigen::MatrixXd::Zero(3, count);
  all.blocks.push_back(std::move(differences));
  return all;
}

// Of configurations shuffled by the seed, numbers first, first + step ... below
// end: whether each pose is held out.
struct Deal {
  std::uint64_t seed = 0;
  int first = 0;
  int step = 1;
  int end = 0;
};

std::vector<char> IsValidation(const std::vector<int>& groups,
                               const Deal& deal) {
  const std::vector<int> order = Shuffled(CountGroups(groups), deal.seed);
  std::vector<char> group_is_validation(order.size(), 0);
  for (int i = deal.first; i < deal.end; i += deal.step) {
    group_is_validation[order[i]] = 1;
  }
  std::vector<char> is_validation;
  for (const int group : groups) {
    is_validation.push_back(group_is_validation[group]);
  }
  return is_validation;
}

std::vector<char> DrawFraction(const Dataset& data, double fraction,
                               std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  const double count = CountGroups(groups);
  const auto num_validation = static_cast<int>(std::lround(fraction * count));
  return IsValidation(groups, {seed, 0, 1, num_validation});
}

HoldOut Split(const Dataset& data, const std::vector<char>& is_validation,
              Communicator* communicator) {
  return HoldOutPoses(data, {is_validation.begin(), is_validation.end()},
                      communicator);
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
  taken.measured = GatherColumns(block.measured, indices);
  taken.sigmas = GatherColumns(block.sigmas, indices);
  return taken;
}

Dataset SelectPoses(const Dataset& data,
                    const std::vector<Eigen::Index>& poses) {
  Dataset selected;
  selected.name = data.name;
  selected.files = data.files;
  selected.joint_values = GatherColumns(data.joint_values, poses);
  if (!data.covariate_names.empty()) {
    selected.covariate_names = data.covariate_names;
    selected.covariates = GatherColumns(data.covariates, poses);
  }
  Gather(data.sources, poses, &selected.sources);
  std::vector<int> new_pose(data.num_poses(), -1);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    new_pose[poses[i]] = static_cast<int>(i);
  }
  SelectShards(data.shards, poses, &selected.shards);
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    const std::vector<Eigen::Index> chosen =
        ChooseObservations(data.blocks[k], poses, new_pose);
    selected.blocks.push_back(
        SelectObservations(data.blocks[k], chosen, new_pose));
    for (std::size_t s = 0; s < selected.shards.size(); ++s) {
      const auto first = std::lower_bound(chosen.begin(), chosen.end(),
                                          data.shards[s].first_observations[k]);
      selected.shards[s].first_observations.push_back(first - chosen.begin());
    }
  }
  return selected;
}

HoldOut HoldOutPoses(const Dataset& data,
                     const std::vector<bool>& is_validation,
                     Communicator* communicator) {
  std::vector<Eigen::Index> train;
  std::vector<Eigen::Index> validation;
  for (std::size_t pose = 0; pose < is_validation.size(); ++pose) {
    (is_validation[pose] ? validation : train)
        .push_back(static_cast<Eigen::Index>(pose));
  }
  HoldOut split{SelectPoses(data, train), SelectPoses(data, validation)};
  Dataset& validation_data = split.validation;
  for (std::size_t k = 0; k < validation_data.blocks.size();) {
    if (validation_data.blocks[k].kind != MeasurementKind::kPointDistance) {
      ++k;
      continue;
    }
    const auto at = static_cast<std::ptrdiff_t>(k);
    validation_data.blocks.erase(validation_data.blocks.begin() + at);
    for (Shard& shard : validation_data.shards) {
      shard.first_observations.erase(shard.first_observations.begin() + at);
    }
  }
  for (Dataset* part : {&split.train, &split.validation}) {
    CountParts(communicator, data, part);
  }
  return split;
}

std::vector<char> DrawHeldOut(const Dataset& data, double fraction,
                              std::uint64_t seed, Communicator* communicator) {
  if (!data.partition) return DrawFraction(data, fraction, seed);
  const Dataset all = ConfigurationsOf(communicator, data);
  std::vector<char> is_validation;
  if (communicator->is_root()) {
    is_validation = DrawFraction(all, fraction, seed);
  }
  const std::string drawn =
      communicator->Broadcast({is_validation.begin(), is_validation.end()});
  const auto first = drawn.begin() + data.partition->first_pose;
  return {first, first + data.num_poses()};
}

HoldOut HoldOutFraction(const Dataset& data, double fraction,
                        std::uint64_t seed, Communicator* communicator) {
  return Split(data, DrawHeldOut(data, fraction, seed, communicator),
               communicator);
}

HoldOut HoldOutFold(const Dataset& data, int folds, int k, std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  return Split(data,
               IsValidation(groups, {seed, k, folds, CountGroups(groups)}),
               SingleProcess());
}

}  // namespace alidade::internal
