#include "src/calibration/stations.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/calibration/position_fit.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kFewestOfStation = 15;
constexpr Eigen::Index kStride = 4;

}  // namespace

PositionSample TakePart(const PositionSample& sample, Eigen::Index from,
                        Eigen::Index to) {
  const Eigen::Index count = to - from;
  PositionSample part;
  part.joint_values = sample.joint_values.middleCols(from, count);
  part.joint_values_before = sample.joint_values_before.middleCols(from, count);
  part.joint_values_after = sample.joint_values_after.middleCols(from, count);
  part.points = sample.points.middleCols(from, count);
  part.numbers.assign(sample.numbers.begin() + from,
                      sample.numbers.begin() + to);
  return part;
}

std::optional<StationChange> FindStationChange(const Arm& arm,
                                               const PositionSample& sample) {
  const Eigen::Index last = sample.size() - kFewestOfStation;
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index best = 0;
  const auto look = [&](Eigen::Index split) {
    if (split < kFewestOfStation || split > last) return;
    const auto square = [&](Eigen::Index from, Eigen::Index to) {
      return static_cast<double>(to - from) *
             std::pow(RmsMisfit(arm, TakePart(sample, from, to)), 2);
    };
    const double sum = square(0, split) + square(split, sample.size());
    if (!(sum < least)) return;
    least = sum;
    best = split;
  };
  for (Eigen::Index split = kFewestOfStation; split <= last; split += kStride) {
    look(split);
  }
  const Eigen::Index near = best;
  for (Eigen::Index step = 1; step < kStride; ++step) {
    look(near - step);
    look(near + step);
  }
  if (best == 0) return std::nullopt;
  return StationChange{best, sample.numbers[static_cast<std::size_t>(best)]};
}

}  // namespace alidade::internal
