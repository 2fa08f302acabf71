#include "src/calibration/frame_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/rotation.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/preparation.h"
#include "src/identifiability/generic_data.h"
#include "src/initialization/frame_start.h"
#include "src/kernel/partition.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

std::vector<std::string> WithoutJoints(const std::vector<std::string>& names,
                                       const ParameterLayout& layout) {
  std::vector<std::string> frames;
  for (const std::string& name : names) {
    const std::optional<int> column = layout.Find(name);
    const bool is_joint =
        column && ParameterLayout::IsJointKind(layout.parameter(*column).kind);
    if (!is_joint) frames.push_back(name);
  }
  return frames;
}

ParameterLayout LayoutOfJob(const JobConfig& config) {
  return ParameterLayout(LayoutShape{
      config.arm.num_joints(), config.arm.num_targets(),
      config.references.num_points(), config.references.num_planes()});
}

bool HoldsPartOfFrames(const JobConfig& config) {
  return !WithoutJoints(config.identifiability.fix, LayoutOfJob(config))
              .empty();
}

// Observations of each kind that a start is found from; the fit takes all.
constexpr Eigen::Index kEnoughForStart = 1000;

// How far frames that were fitted at the nominal geometry may be from where
// they are.
constexpr double kMisplacedLength = 0.05;  // m
constexpr double kMisplacedAngle = 0.05;   // rad

// Finds frames and references from the data alone. What it cannot find it
// leaves as it is.
class FrameStarter {
 public:
  FrameStarter(const JobConfig& config, Dataset data)
      : options_(config.identifiability),
        data_(std::move(data)),
        arm_(config.arm),
        references_(config.references),
        frames_(LastFrames(config.arm, data_.joint_values)) {}

  void Run() {
    FindMeasuredTargets();
    StartBaseAndTargets();
    StartContacts();
    StartDistances();
    StartPlanes();
  }

  const Arm& arm() const { return arm_; }
  const References& references() const { return references_; }

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

  bool MovesTools() const { return options_.candidates.tool; }
  bool MovesBase() const { return options_.candidates.base; }

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

  const IdentifiabilityOptions& options_;
  const Dataset data_;
  Arm arm_;
  References references_;
  const Poses frames_;
  std::vector<bool> is_found_;  // one per target
};

double MedianError(const MeasurementModel& model, const Dataset& data) {
  std::vector<double> errors =
      InOrder(model.communicator(), data,
              CountedLengths(model.Errors(model.NominalValues(), data), data));
  return ComputeOnRoot(model.communicator(), data, [&] {
    if (errors.empty()) return std::numeric_limits<double>::infinity();
    const auto middle =
        errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  });
}

}  // namespace

IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options,
                                  const ParameterLayout& layout) {
  IdentifiabilityOptions frames = options;
  // The published rules know joints alone.
  frames.method = IdentifiabilityMethod::kRank;
  frames.candidates.joints = false;
  frames.fix = WithoutJoints(options.fix, layout);
  frames.free = WithoutJoints(options.free, layout);
  frames.prefer = WithoutJoints(options.prefer, layout);
  return frames;
}

bool HasUnknownFrames(const JobConfig& config) {
  const auto is_unknown = [](const auto& reference) {
    return !reference.is_known;
  };
  const References& references = config.references;
  return config.identifiability.candidates.base ||
         config.identifiability.candidates.tool ||
         std::any_of(references.points.begin(), references.points.end(),
                     is_unknown) ||
         std::any_of(references.planes.begin(), references.planes.end(),
                     is_unknown);
}

bool FitFrames(JobConfig* config, const Execution& execution) {
  if (!HasUnknownFrames(*config) || config->truth) return false;
  const Arm given = config->arm;
  const References given_references = config->references;
  bool is_found = false;
  if (!HoldsPartOfFrames(*config)) {
    FrameStarter starter(*config, EvenSubset(execution.communicator,
                                             config->data, kEnoughForStart));
    starter.Run();
    const MeasurementModel found(starter.arm(), starter.references(),
                                 execution);
    const MeasurementModel stated(given, given_references, execution);
    if (MedianError(found, config->data) < MedianError(stated, config->data)) {
      config->arm = starter.arm();
      config->references = starter.references();
      is_found = true;
    }
  }
  const MeasurementModel model(config->arm, config->references, execution);
  const Fit fit = FitPart(*config, model,
                          FramesOnly(config->identifiability, model.layout()));
  // A start that was found stays better than none.
  if (!fit.summary.IsSolutionUsable()) return is_found;
  config->arm = model.layout().WithValues(config->arm, fit.values);
  config->references = model.ReferencesAt(fit.values);
  // From here on frames are known better than before: the nominal geometry
  // misplaces them by a multiple of its own error, not by metres.
  PriorTolerances& priors = config->identifiability.priors;
  priors.frame_length = std::min(priors.frame_length, kMisplacedLength);
  priors.frame_angle = std::min(priors.frame_angle, kMisplacedAngle);
  return true;
}

}  // namespace alidade::internal
