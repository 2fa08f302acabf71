#include "src/io/dataset_builder.h"

#include <algorithm>

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

void AppendObservations(const ObservationBlock& block, int first_pose,
                        std::vector<Observation>* observations) {
  const bool is_difference = block.kind == MeasurementKind::kDifference;
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    Observation observation;
    observation.kind = block.kind;
    observation.pose = block.pose(i) + first_pose;
    observation.target = block.target(i);
    if (!block.references.empty()) observation.reference = block.references[i];
    if (!block.seconds.empty()) {
      observation.second = block.seconds[i] + (is_difference ? first_pose : 0);
    }
    observation.measured = block.measured.col(i);
    observation.sigmas = block.sigmas.col(i);
    if (!block.whiteners.empty()) observation.whitener = block.whiteners[i];
    observations->push_back(std::move(observation));
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

Dataset MergeDatasets(const std::vector<Dataset>& parts) {
  if (parts.size() == 1) return parts.front();
  Dataset all;
  Eigen::Index num_poses = 0;
  for (const Dataset& part : parts) num_poses += part.num_poses();
  all.joint_values.resize(parts.front().num_joints(), num_poses);
  std::vector<Observation> observations;
  Eigen::Index first = 0;
  for (const Dataset& part : parts) {
    all.name += (all.name.empty() ? "" : ", ") + part.name;
    all.joint_values.middleCols(first, part.num_poses()) = part.joint_values;
    const auto first_file = static_cast<int>(all.files.size());
    for (const PoseSource& source : part.sources) {
      all.sources.push_back({source.file + first_file, source.line});
    }
    all.files.insert(all.files.end(), part.files.begin(), part.files.end());
    for (const ObservationBlock& block : part.blocks) {
      AppendObservations(block, static_cast<int>(first), &observations);
    }
    first += part.num_poses();
  }
  all.blocks = MakeBlocks(observations, num_poses);
  return all;
}

}  // namespace alidade
