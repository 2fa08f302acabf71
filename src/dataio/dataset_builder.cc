#include "src/dataio/dataset_builder.h"

#include <algorithm>

namespace alidade::internal {
namespace {

ObservationBlock MakeBlock(const std::vector<const Observation*>& observations,
                           Eigen::Index num_poses) {
  ObservationBlock block;
  block.kind = observations.front()->kind;
  const auto size = static_cast<Eigen::Index>(observations.size());
  MatrixBuilder measured(block.rows_each(), size);
  MatrixBuilder sigmas(block.rows_each(), size);
  bool has_whitener = false;
  bool has_target = false;
  for (Eigen::Index i = 0; i < size; ++i) {
    const Observation& observation = *observations[i];
    measured.map().col(i) = observation.measured;
    sigmas.map().col(i) = observation.sigmas;
    block.poses.push_back(observation.pose);
    block.targets.push_back(observation.target);
    has_target = has_target || observation.target != 0;
    has_whitener = has_whitener || observation.whitener.size() > 0;
    if (HasReference(block.kind)) {
      block.references.push_back(observation.reference);
    }
    if (HasSecond(block.kind)) block.seconds.push_back(observation.second);
  }
  block.measured = measured.Freeze();
  block.sigmas = sigmas.Freeze();
  DropTrivialPoses(num_poses, &block);
  if (!has_target) block.targets.clear();
  if (has_whitener) {
    for (const Observation* one : observations) {
      block.whiteners.push_back(one->whitener);
    }
  }
  return block;
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

}  // namespace alidade::internal
