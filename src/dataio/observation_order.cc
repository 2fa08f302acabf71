#include "src/dataio/observation_order.h"

#include <algorithm>

namespace alidade::internal {

std::vector<ObservationRef> InOrderOfPoses(const Dataset& data) {
  std::vector<ObservationRef> rows;
  rows.reserve(static_cast<std::size_t>(data.num_observations()));
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) rows.push_back({&block, i});
  }
  const auto is_before = [](const ObservationRef& a, const ObservationRef& b) {
    return a.pose() < b.pose();
  };
  if (!std::is_sorted(rows.begin(), rows.end(), is_before)) {
    std::stable_sort(rows.begin(), rows.end(), is_before);
  }
  return rows;
}

StatedSigmas FindStatedSigmas(const Dataset& data) {
  StatedSigmas stated;
  for (const ObservationBlock& block : data.blocks) {
    const auto above_zero = block.sigmas.map().array() > 0.0;
    stated.positions = stated.positions && above_zero.topRows(3).all();
    if (block.kind != MeasurementKind::kPose) continue;
    stated.orientations = stated.orientations && above_zero.bottomRows(3).all();
  }
  return stated;
}

}  // namespace alidade::internal
