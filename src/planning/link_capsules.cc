#include "src/planning/link_capsules.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

using Eigen::Vector3d;

// A link that has a length at this pose.
struct Link {
  int number = 0;  // moves with the joint of this number; 0 = the base
  Segment segment;
  double start = 0.0;  // along the chain (m)
  double end = 0.0;
};

double PointDistance(const Vector3d& point, const Segment& segment) {
  const Vector3d along = segment.to - segment.from;
  const double square = along.squaredNorm();
  const double place =
      square > 0.0
          ? std::clamp((point - segment.from).dot(along) / square, 0.0, 1.0)
          : 0.0;
  return (point - segment.from - place * along).norm();
}

std::vector<Link> LinksAt(const Arm& arm, const double* joint_values,
                          ChainAxes* axes) {
  constexpr double kSamePlace = 1e-6;  // m
  ComputeChainAxes(arm, joint_values, axes);
  std::vector<Link> links;
  double length = 0.0;
  const int n = arm.num_joints();
  const auto origin = [&](int k) -> Vector3d {
    if (k < n) return axes->origin_before.col(k);
    return k == n ? axes->instrument_from_last.translation()
                  : axes->instrument_from_target.translation();
  };
  for (int k = 0; k <= n; ++k) {
    const Segment segment = {origin(k), origin(k + 1)};
    const double own = (segment.to - segment.from).norm();
    if (own < kSamePlace) continue;
    links.push_back({k, segment, length, length + own});
    length += own;
  }
  return links;
}

std::string NameOf(const Link& link) {
  return link.number == 0 ? "base" : "link " + std::to_string(link.number);
}

}  // namespace

double SegmentDistance(const Segment& a, const Segment& b) {
  // The square of the distance is convex over both places along the segments:
  // its least value is where the lines are nearest, if that is within both
  // segments, or else at an end of one of them.
  double least = std::min({PointDistance(a.from, b), PointDistance(a.to, b),
                           PointDistance(b.from, a), PointDistance(b.to, a)});
  const Vector3d along_a = a.to - a.from;
  const Vector3d along_b = b.to - b.from;
  const Vector3d normal = along_a.cross(along_b);
  const double square = normal.squaredNorm();
  if (!(square > 0.0)) return least;
  const Vector3d between = b.from - a.from;
  const double place_a = between.cross(along_b).dot(normal) / square;
  const double place_b = between.cross(along_a).dot(normal) / square;
  if (place_a >= 0.0 && place_a <= 1.0 && place_b >= 0.0 && place_b <= 1.0) {
    least = std::min(least, std::abs(between.dot(normal)) / std::sqrt(square));
  }
  return least;
}

double TypicalLinkRadius(const Arm& arm) { return 0.05 * ArmReach(arm); }

LinkCaution FindLinkOverlaps(const Arm& arm,
                             const Eigen::MatrixXd& joint_values,
                             double radius) {
  LinkCaution caution;
  caution.radius = radius;
  if (!(radius > 0.0)) return caution;
  ChainAxes axes;
  for (Eigen::Index pose = 0; pose < joint_values.cols(); ++pose) {
    const Eigen::VectorXd values = joint_values.col(pose);
    const std::vector<Link> links = LinksAt(arm, values.data(), &axes);
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (std::size_t k = i + 1; k < links.size(); ++k) {
        if (links[k].start - links[i].end <= 2.0 * radius) continue;
        const double overlap =
            2.0 * radius - SegmentDistance(links[i].segment, links[k].segment);
        if (overlap <= 0.0) continue;
        caution.overlaps.push_back({static_cast<int>(pose) + 1,
                                    NameOf(links[i]), NameOf(links[k]),
                                    overlap});
      }
    }
  }
  return caution;
}

}  // namespace alidade::internal
