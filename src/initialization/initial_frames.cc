#include "src/initialization/initial_frames.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/rotation.h"
#include "src/initialization/frame_start.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

// Finds frames and references from the data alone. What it cannot find it
// leaves as it is.
class FrameSearch {
 public:
  FrameSearch(InitialFrames start, Dataset data, CandidateGroups candidates)
      : candidates_(candidates),
        data_(std::move(data)),
        arm_(std::move(start.arm)),
        references_(std::move(start.references)),
        frames_(LastFrames(arm_, data_.joint_values)) {}

  InitialFrames Run() {
    FindMeasuredTargets();
    StartBaseAndTargets();
    StartContacts();
    StartDistances();
    StartPlanes();
    return {std::move(arm_), std::move(references_)};
  }

 private:
  static Poses LastFrames(const Arm& arm, const SharedMatrix& joint_values) {
    Arm in_base = arm;
    in_base.instrument_from_base.setIdentity();
    Poses frames;
    frames.reserve(joint_values.cols());
    ChainAxes axes;
    for (Eigen::Index i = 0; i < joint_values.cols(); ++i) {
      ComputeChainAxes(in_base, joint_values.col(i).data(), &axes);
      frames.push_back(axes.instrument_from_last);
    }
    return frames;
  }

  bool MovesTools() const { return candidates_.tool; }
  bool MovesBase() const { return candidates_.base; }

  // Everything that was measured in full at a place.
  void StartBaseAndTargets() {
    if (!MovesBase()) return;
    if (MovesTools() && StartByPoses()) return;
    Poses frames;
    std::vector<int> targets;
    std::vector<Eigen::Vector3d> points;
    for (const ObservationBlock& block : data_.blocks) {
      if (!HoldsPosition(block.kind)) continue;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (!block.sigmas.col(i).head<3>().allFinite()) continue;
        frames.push_back(frames_[block.pose(i)]);
        targets.push_back(block.target(i));
        points.emplace_back(block.measured.col(i).head<3>());
      }
    }
    if (points.empty()) return;
    Eigen::Matrix3Xd measured(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      measured.col(static_cast<Eigen::Index>(i)) = points[i];
    }
    if (MovesTools()) {
      StartByPositions(frames, measured, targets);
    } else {
      StartByRigidFit(frames, measured, targets);
    }
  }

  bool StartByPoses() {
    Poses frames;
    Poses measured;
    for (const ObservationBlock& block : data_.blocks) {
      if (block.kind != MeasurementKind::kPose) continue;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (block.target(i) != 0 || block.Dimension(i) < 6) continue;
        frames.push_back(frames_[block.pose(i)]);
        const Eigen::Vector3d rotation = block.measured.col(i).tail<3>();
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = RotationFromVector<double>(rotation);
        pose.translation() = block.measured.col(i).head<3>();
        measured.push_back(pose);
      }
    }
    const std::optional<PoseStart> start = StartFromPoses(frames, measured);
    if (!start) return false;
    arm_.instrument_from_base = start->instrument_from_base;
    arm_.last_from_target() = start->last_from_target;
    return true;
  }

  // Numbers the targets that were seen from 0, as StartFromPositions wants.
  void StartByPositions(const Poses& frames, const Eigen::Matrix3Xd& measured,
                        std::vector<int> targets) {
    std::vector<int> seen = targets;
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (int& target : targets) {
      target = static_cast<int>(
          std::lower_bound(seen.begin(), seen.end(), target) - seen.begin());
    }
    const std::optional<PositionStart> start = StartFromPositions(
        frames, measured, targets, static_cast<int>(seen.size()));
    if (!start) return;
    arm_.instrument_from_base = start->instrument_from_base;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      arm_.last_from_target(seen[k]).translation() =
          start->targets.col(static_cast<Eigen::Index>(k));
    }
  }

  void StartByRigidFit(const Poses& frames, const Eigen::Matrix3Xd& measured,
                       const std::vector<int>& targets) {
    Eigen::Matrix3Xd points(3, measured.cols());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      points.col(static_cast<Eigen::Index>(i)) =
          frames[i] * arm_.last_from_target(targets[i]).translation();
    }
    const std::optional<RigidFit> fit = FitRigid(points, measured);
    if (fit) arm_.instrument_from_base = fit->b_from_a;
  }

  // Targets whose positions were measured are found with the base.
  void FindMeasuredTargets() {
    is_found_.assign(arm_.num_targets(), !MovesTools());
    for (const ObservationBlock& block : data_.blocks) {
      if (!HoldsPosition(block.kind)) continue;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        is_found_[block.target(i)] = true;
      }
    }
  }

  void Found(int target, const Eigen::Vector3d& place) {
    if (is_found_[target]) return;
    arm_.last_from_target(target).translation() = place;
    is_found_[target] = true;
  }

  // Balls in sockets, each target with its points.
  void StartContacts() {
    for (const ObservationBlock& block : data_.blocks) {
      if (block.kind != MeasurementKind::kFixedPoint) continue;
      for (int target = 0; target < arm_.num_targets(); ++target) {
        StartContactsOf(block, target);
      }
    }
  }

  void StartContactsOf(const ObservationBlock& block, int target) {
    Poses frames;
    std::vector<int> points;
    std::vector<int> seen;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      if (block.target(i) != target) continue;
      frames.push_back(frames_[block.pose(i)]);
      const int point = block.references[i];
      const auto found = std::find(seen.begin(), seen.end(), point);
      points.push_back(static_cast<int>(found - seen.begin()));
      if (found == seen.end()) seen.push_back(point);
    }
    if (frames.empty()) return;
    if (!is_found_[target]) {
      const std::optional<FixedPointStart> start =
          StartFromFixedPoints(arm_.instrument_from_base, frames, points,
                               static_cast<int>(seen.size()));
      if (start) Found(target, start->target);
    }
    MoveToMeans(frames, points, seen, target);
  }

  // Unknown points go to the mean of what touched them.
  void MoveToMeans(const Poses& frames, const std::vector<int>& points,
                   const std::vector<int>& seen, int target) {
    Eigen::Matrix3Xd sums =
        Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(seen.size()));
    std::vector<int> counts(seen.size(), 0);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      sums.col(points[i]) +=
          arm_.instrument_from_base *
          (frames[i] * arm_.last_from_target(target).translation());
      ++counts[points[i]];
    }
    for (std::size_t k = 0; k < seen.size(); ++k) {
      ReferencePoint& point = references_.points[seen[k]];
      if (point.is_known) continue;
      point.position = sums.col(static_cast<Eigen::Index>(k)) / counts[k];
    }
  }

  // The frames at which a target was measured against a reference by this
  // kind, and what was measured.
  struct Against {
    Poses frames;
    Eigen::VectorXd lengths;
  };

  Against MeasuredAgainst(MeasurementKind kind, int reference,
                          int target) const {
    Against against;
    std::vector<double> lengths;
    for (const ObservationBlock& block : data_.blocks) {
      if (block.kind != kind) continue;
      for (Eigen::Index i = 0; i < block.size(); ++i) {
        if (block.references[i] != reference || block.target(i) != target) {
          continue;
        }
        against.frames.push_back(frames_[block.pose(i)]);
        lengths.push_back(block.measured(0, i));
      }
    }
    against.lengths = Eigen::Map<const Eigen::VectorXd>(
        lengths.data(), static_cast<Eigen::Index>(lengths.size()));
    return against;
  }

  // Of an anchor or plane the start finds the target too; the first that does
  // settles it.
  void StartDistances() {
    for (int anchor = 0; anchor < references_.num_points(); ++anchor) {
      ReferencePoint& point = references_.points[anchor];
      for (int target = 0; target < arm_.num_targets(); ++target) {
        if (point.is_known) break;
        const Against against =
            MeasuredAgainst(MeasurementKind::kDistance, anchor, target);
        if (against.frames.empty()) continue;
        const std::optional<DistanceStart> start = StartFromDistances(
            arm_.instrument_from_base, against.frames, against.lengths);
        if (!start) continue;
        point.position = start->anchor;
        Found(target, start->target);
        break;
      }
    }
  }

  void StartPlanes() {
    for (int index = 0; index < references_.num_planes(); ++index) {
      ReferencePlane& plane = references_.planes[index];
      for (int target = 0; target < arm_.num_targets(); ++target) {
        if (plane.is_known) break;
        const Against against =
            MeasuredAgainst(MeasurementKind::kPlane, index, target);
        if (against.frames.empty()) continue;
        const std::optional<PlaneStart> start =
            StartFromPlane(arm_.instrument_from_base, against.frames);
        if (!start) continue;
        plane.normal = start->normal;
        plane.offset = start->offset;
        Found(target, start->target);
        break;
      }
    }
  }

  const CandidateGroups candidates_;
  const Dataset data_;
  Arm arm_;
  References references_;
  const Poses frames_;
  std::vector<bool> is_found_;  // one per target
};

}  // namespace

InitialFrames FindInitialFrames(const Arm& arm, const References& references,
                                Dataset data, CandidateGroups candidates) {
  return FrameSearch({arm, references}, std::move(data), candidates).Run();
}

}  // namespace alidade::internal
