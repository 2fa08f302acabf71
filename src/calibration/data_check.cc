#include "src/calibration/data_check.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/error.h"

namespace alidade::internal {
namespace {

[[noreturn]] void Fail(const Dataset& data, const std::string& what) {
  SourceLocation location;
  location.file = data.name;
  throw InputError(location, what);
}

std::string Text(std::int64_t number) { return std::to_string(number); }

// Every entry of a list, which is empty or has one for each observation, is an
// index below `count`.
void RequireIndices(const Dataset& data, const ObservationBlock& block,
                    const std::vector<int>& list, const std::string& what,
                    std::int64_t count, bool may_be_empty) {
  if (list.empty() && (may_be_empty || block.size() == 0)) return;
  const std::string kind =
      std::string("observations of kind \"") + NameOf(block.kind) + "\": ";
  if (static_cast<Eigen::Index>(list.size()) != block.size()) {
    Fail(data, kind + Text(static_cast<std::int64_t>(list.size())) +
                   " indices of " + what + ", expected " + Text(block.size()));
  }
  for (const int index : list) {
    if (index >= 0 && index < count) continue;
    Fail(data, kind + what + " " + Text(index) + " is not among the " +
                   Text(count) + " there are (counted from 0)");
  }
}

void RequireConsistentBlock(const Dataset& data, const ObservationBlock& block,
                            const Arm& arm, const References& references) {
  const std::string kind = NameOf(block.kind);
  const auto require_size = [&](const SharedMatrix& matrix, const char* what) {
    if (matrix.rows() == block.rows_each() && matrix.cols() == block.size()) {
      return;
    }
    Fail(data, std::string(what) + " of kind \"" + kind + "\" are " +
                   Text(matrix.rows()) + " x " + Text(matrix.cols()) +
                   ", expected " + Text(block.rows_each()) + " x " +
                   Text(block.size()) + ", one column an observation");
  };
  require_size(block.measured, "measured values");
  require_size(block.sigmas, "sigmas");
  const bool is_of_points = block.kind == MeasurementKind::kPointDistance;
  if (block.poses.empty() && !is_of_points && block.size() > 0 &&
      block.size() != data.num_poses()) {
    Fail(data, Text(block.size()) + " observations of kind \"" + kind +
                   "\" at " + Text(data.num_poses()) +
                   " poses, expected one a pose where none is named");
  }
  RequireIndices(data, block, block.poses, "pose", data.num_poses(), true);
  RequireIndices(data, block, block.targets, "target", arm.num_targets(), true);
  RequireIndices(data, block, block.references, "reference",
                 block.kind == MeasurementKind::kPlane
                     ? references.num_planes()
                     : references.num_points(),
                 !HasReference(block.kind));
  RequireIndices(data, block, block.seconds,
                 is_of_points ? "second point" : "second pose",
                 is_of_points ? references.num_points() : data.num_poses(),
                 !HasSecond(block.kind));
}

}  // namespace

void RequireConsistent(const Dataset& data, const Arm& arm,
                       const References& references) {
  if (data.num_poses() > 0 && data.num_joints() != arm.num_joints()) {
    Fail(data, "the data have " + Text(data.num_joints()) +
                   " joint values a pose, expected " + Text(arm.num_joints()) +
                   ", as the arm");
  }
  for (const ObservationBlock& block : data.blocks) {
    RequireConsistentBlock(data, block, arm, references);
  }
}

void RequireMeasurements(const Dataset& data) {
  if (data.num_poses() == 0) Fail(data, "the data have no pose");
  for (const ObservationBlock& block : data.blocks) {
    if ((block.sigmas.map().array() > 0.0).all()) continue;
    Fail(data, std::string("a sigma of kind \"") + NameOf(block.kind) +
                   "\" is not above 0; what was not measured has an infinite "
                   "one");
  }
  RequireFinite(data);
}

void RequireFinite(const Dataset& data) {
  const auto where = [&data](int pose) {
    const std::string source = SourceOf(data, pose);
    return source.empty() ? "pose " + Text(pose) + " (from 0)" : source;
  };
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    if (data.joint_values.col(i).allFinite()) continue;
    Fail(data,
         where(static_cast<int>(i)) + ": a joint value is not a finite number");
  }
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      for (int row = 0; row < block.rows_each(); ++row) {
        if (std::isinf(block.sigmas(row, i)) ||
            std::isfinite(block.measured(row, i))) {
          continue;
        }
        Fail(data, (block.kind == MeasurementKind::kPointDistance
                        ? "a distance of points"
                        : where(block.pose(i))) +
                       ": a measured value is not a finite number; leave it "
                       "out, or give it an infinite sigma");
      }
    }
  }
}

}  // namespace alidade::internal
