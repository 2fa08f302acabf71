#include "src/data/merge.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "src/data/merge_blocks.h"

namespace alidade::internal {
namespace {

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
  MatrixBuilder measured(all.rows_each(), size);
  MatrixBuilder sigmas(all.rows_each(), size);
  Eigen::Index first = 0;
  for (const PartBlock& part : parts) {
    const ObservationBlock& block = *part.block;
    measured.map().middleCols(first, block.size()) = block.measured.map();
    sigmas.map().middleCols(first, block.size()) = block.sigmas.map();
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
  all.measured = measured.Freeze();
  all.sigmas = sigmas.Freeze();
  DropTrivialPoses(num_poses, &all);
  return all;
}

// Of all parts, which have the same or none at all.
void MergeCovariates(const std::vector<Dataset>& parts, Eigen::Index num_poses,
                     Dataset* all) {
  all->covariate_names = parts.front().covariate_names;
  if (all->covariate_names.empty()) return;
  MatrixBuilder covariates(
      static_cast<Eigen::Index>(all->covariate_names.size()), num_poses);
  Eigen::Index first = 0;
  for (const Dataset& part : parts) {
    CHECK(part.covariate_names == all->covariate_names);
    covariates.map().middleCols(first, part.num_poses()) =
        part.covariates.map();
    first += part.num_poses();
  }
  all->covariates = covariates.Freeze();
}

Dataset MergeDatasets(std::vector<Dataset> parts) {
  if (parts.size() == 1) return std::move(parts.front());
  Dataset all;
  Eigen::Index num_poses = 0;
  for (const Dataset& part : parts) num_poses += part.num_poses();
  MatrixBuilder joint_values(parts.front().num_joints(), num_poses);
  const bool has_sources =
      std::all_of(parts.begin(), parts.end(), [](const Dataset& part) {
        return part.num_poses() == 0 || !part.sources.empty();
      });
  MergeCovariates(parts, num_poses, &all);
  std::vector<std::vector<PartBlock>> by_kind;
  Eigen::Index first = 0;
  for (const Dataset& part : parts) {
    all.shards.push_back({first, {}});
    all.name += (all.name.empty() ? "" : ", ") + part.name;
    joint_values.map().middleCols(first, part.num_poses()) =
        part.joint_values.map();
    const auto first_file = static_cast<int>(all.files.size());
    if (has_sources) {
      all.sources.Append(part.sources, first_file);
    }
    all.files.insert(all.files.end(), part.files.begin(), part.files.end());
    for (const ObservationBlock& block : part.blocks) {
      if (block.size() == 0) continue;
      AddToKind({&block, static_cast<int>(first), all.shards.size() - 1},
                &by_kind);
    }
    first += part.num_poses();
  }
  all.joint_values = joint_values.Freeze();
  for (const std::vector<PartBlock>& blocks : by_kind) {
    all.blocks.push_back(MergeBlocks(blocks, num_poses));
    AddToShards(blocks, &all.shards);
  }
  return all;
}

}  // namespace alidade::internal
