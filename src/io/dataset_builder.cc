#include "src/io/dataset_builder.h"

#include <algorithm>
#include <utility>

namespace alidade {
namespace {

bool HasSecond(MeasurementKind kind) {
  return kind == MeasurementKind::kDifference ||
         kind == MeasurementKind::kPointDistance;
}

bool CountsFromZero(const std::vector<int>& poses, Eigen::Index num_poses) {
  if (static_cast<Eigen::Index>(poses.size()) != num_poses) return false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i] != static_cast<int>(i)) return false;
  }
  return true;
}

ObservationBlock MakeBlock(const std::vector<const Observation*>& observations,
                           Eigen::Index num_poses) {
  ObservationBlock block;
  block.kind = observations.front()->kind;
  const auto size = static_cast<Eigen::Index>(observations.size());
  block.measured.resize(block.rows_each(), size);
  block.sigmas.resize(block.rows_each(), size);
  bool has_whitener = false;
  bool has_target = false;
  for (Eigen::Index i = 0; i < size; ++i) {
    const Observation& observation = *observations[i];
    block.measured.col(i) = observation.measured;
    block.sigmas.col(i) = observation.sigmas;
    block.poses.push_back(observation.pose);
    block.targets.push_back(observation.target);
    has_target = has_target || observation.target != 0;
    has_whitener = has_whitener || observation.whitener.size() > 0;
    if (HasReference(block.kind)) {
      block.references.push_back(observation.reference);
    }
    if (HasSecond(block.kind)) block.seconds.push_back(observation.second);
  }
  if (block.kind == MeasurementKind::kPointDistance ||
      CountsFromZero(block.poses, num_poses)) {
    block.poses.clear();
  }
  if (!has_target) block.targets.clear();
  if (has_whitener) {
    for (const Observation* one : observations) {
      block.whiteners.push_back(one->whitener);
    }
  }
  return block;
}

// A block of a part, and which part that is.
struct PartBlock {
  const ObservationBlock* block = nullptr;
  int first_pose = 0;
  std::size_t number = 0;  // of the part
};

void AppendShifted(const std::vector<int>& from, int shift,
                   std::vector<int>* to) {
  const std::size_t first = to->size();
  to->resize(first + from.size());
  std::transform(from.begin(), from.end(),
                 to->begin() + static_cast<std::ptrdiff_t>(first),
                 [&](int value) { return value + shift; });
}

// The list of one part; of as many zeros where the part leaves it out.
void AppendList(const std::vector<int>& from, Eigen::Index size, int shift,
                std::vector<int>* to) {
  if (from.empty()) {
    to->resize(to->size() + static_cast<std::size_t>(size), 0);
  } else {
    AppendShifted(from, shift, to);
  }
}

void AppendPoses(const PartBlock& part, std::vector<int>* poses) {
  if (!part.block->poses.empty()) {
    AppendShifted(part.block->poses, part.first_pose, poses);
    return;
  }
  const auto size = static_cast<int>(part.block->size());
  for (int i = 0; i < size; ++i) poses->push_back(part.first_pose + i);
}

// Kinds stay in the order that they first come in.
void AddToKind(const PartBlock& part,
               std::vector<std::vector<PartBlock>>* by_kind) {
  for (std::vector<PartBlock>& blocks : *by_kind) {
    if (blocks.front().block->kind != part.block->kind) continue;
    blocks.push_back(part);
    return;
  }
  by_kind->push_back({part});
}

// Blocks of one kind, one after the other.
ObservationBlock MergeBlocks(const std::vector<PartBlock>& parts,
                             Eigen::Index num_poses) {
  ObservationBlock all;
  all.kind = parts.front().block->kind;
  const bool is_difference = all.kind == MeasurementKind::kDifference;
  Eigen::Index size = 0;
  bool has_target = false;
  bool has_whitener = false;
  for (const PartBlock& part : parts) {
    size += part.block->size();
    const auto is_other = [](int target) { return target != 0; };
    const std::vector<int>& targets = part.block->targets;
    has_target =
        has_target || std::any_of(targets.begin(), targets.end(), is_other);
    has_whitener = has_whitener || !part.block->whiteners.empty();
  }
  all.measured.resize(all.rows_each(), size);
  all.sigmas.resize(all.rows_each(), size);
  Eigen::Index first = 0;
  for (const PartBlock& part : parts) {
    const ObservationBlock& block = *part.block;
    all.measured.middleCols(first, block.size()) = block.measured;
    all.sigmas.middleCols(first, block.size()) = block.sigmas;
    first += block.size();
    AppendPoses(part, &all.poses);
    if (has_target) AppendList(block.targets, block.size(), 0, &all.targets);
    if (HasReference(all.kind)) {
      AppendList(block.references, block.size(), 0, &all.references);
    }
    if (HasSecond(all.kind)) {
      AppendList(block.seconds, block.size(),
                 is_difference ? part.first_pose : 0, &all.seconds);
    }
    if (!has_whitener) continue;
    all.whiteners.insert(all.whiteners.end(), block.whiteners.begin(),
                         block.whiteners.end());
    all.whiteners.resize(static_cast<std::size_t>(first));
  }
  if (all.kind == MeasurementKind::kPointDistance ||
      CountsFromZero(all.poses, num_poses)) {
    all.poses.clear();
  }
  return all;
}

// Where each part's observations begin in the block that these are merged to.
void AddToShards(const std::vector<PartBlock>& parts,
                 std::vector<Shard>* shards) {
  Eigen::Index first = 0;
  auto part = parts.begin();
  for (std::size_t number = 0; number < shards->size(); ++number) {
    (*shards)[number].first_observations.push_back(first);
    if (part == parts.end() || part->number != number) continue;
    first += part->block->size();
    ++part;
  }
}

}  // namespace

std::vector<ObservationBlock> MakeBlocks(
    const std::vector<Observation>& observations, Eigen::Index num_poses) {
  std::vector<std::vector<const Observation*>> by_kind;
  for (const Observation& observation : observations) {
    const auto same = [&](const std::vector<const Observation*>& list) {
      return list.front()->kind == observation.kind;
    };
    const auto found = std::find_if(by_kind.begin(), by_kind.end(), same);
    if (found != by_kind.end()) {
      found->push_back(&observation);
    } else {
      by_kind.push_back({&observation});
    }
  }
  std::vector<ObservationBlock> blocks;
  for (const auto& list : by_kind) blocks.push_back(MakeBlock(list, num_poses));
  return blocks;
}

Dataset MergeDatasets(std::vector<Dataset> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  Dataset all;
  Eigen::Index num_poses = 0;
  for (const Dataset& part : parts) num_poses += part.num_poses();
  all.joint_values.resize(parts.front().num_joints(), num_poses);
  std::vector<std::vector<PartBlock>> by_kind;
  Eigen::Index first = 0;
  for (const Dataset& part : parts) {
    all.shards.push_back({first, {}});
    all.name += (all.name.empty() ? "" : ", ") + part.name;
    all.joint_values.middleCols(first, part.num_poses()) = part.joint_values;
    const auto first_file = static_cast<int>(all.files.size());
    for (const PoseSource& source : part.sources) {
      all.sources.push_back({source.file + first_file, source.line});
    }
    all.files.insert(all.files.end(), part.files.begin(), part.files.end());
    for (const ObservationBlock& block : part.blocks) {
      if (block.size() == 0) continue;
      AddToKind({&block, static_cast<int>(first), all.shards.size() - 1},
                &by_kind);
    }
    first += part.num_poses();
  }
  for (const std::vector<PartBlock>& blocks : by_kind) {
    all.blocks.push_back(MergeBlocks(blocks, num_poses));
    AddToShards(blocks, &all.shards);
  }
  return all;
}

}  // namespace alidade
