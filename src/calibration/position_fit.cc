#include "src/calibration/position_fit.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "src/calibration/frame_fit.h"
#include "src/calibration/preparation.h"
#include "src/common/constants.h"
#include "src/initialization/frame_start.h"
#include "src/model/chain_axes.h"

namespace alidade::internal {
namespace {

// Of the positions in a calibration (m).
constexpr double kSigma = 1e-4;

std::optional<PositionStart> Place(const Arm& arm,
                                   const PositionSample& sample) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  std::vector<Eigen::Isometry3d> frames;
  ChainAxes axes;
  for (Eigen::Index i = 0; i < sample.points.cols(); ++i) {
    ComputeChainAxes(in_base, sample.joint_values.col(i).data(), &axes);
    frames.push_back(axes.instrument_from_last);
  }
  return StartFromPositions(frames, sample.points,
                            std::vector<int>(frames.size(), 0), 1);
}

// Every third position, or all others.
PositionSample Part(const PositionSample& sample, bool held_out) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < sample.size(); ++k) {
    if ((k % 3 == 2) == held_out) columns.push_back(k);
  }
  PositionSample part;
  part.joint_values = sample.joint_values(Eigen::all, columns);
  part.points = sample.points(Eigen::all, columns);
  return part;
}

}  // namespace

double Misfit(const Arm& arm, const PositionSample& sample) {
  const std::optional<PositionStart> start = Place(arm, sample);
  return start ? start->misfit.median : kInfinity;
}

double RmsMisfit(const Arm& arm, const PositionSample& sample) {
  const std::optional<PositionStart> start = Place(arm, sample);
  return start ? start->misfit.rms : kInfinity;
}

double MisfitAsStated(const Arm& arm, const PositionSample& sample) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  Eigen::Matrix3Xd targets(3, sample.points.cols());
  ChainAxes axes;
  for (Eigen::Index i = 0; i < targets.cols(); ++i) {
    ComputeChainAxes(in_base, sample.joint_values.col(i).data(), &axes);
    targets.col(i) = axes.instrument_from_target.translation();
  }
  const std::optional<RigidFit> fit = FitRigid(targets, sample.points);
  if (!fit) return kInfinity;
  Eigen::VectorXd misfits =
      (fit->b_from_a * targets - sample.points).colwise().norm();
  if (!misfits.allFinite()) return kInfinity;
  double* const middle = misfits.data() + misfits.size() / 2;
  std::nth_element(misfits.data(), middle, misfits.data() + misfits.size());
  return *middle;
}

double SolvedMisfit(const Arm& arm, const PositionSample& sample,
                    bool with_wide_priors, const CandidateGroups& candidates) {
  const PositionSample fitted = Part(sample, false);
  const PositionSample others = Part(sample, true);
  const auto data = [](const PositionSample& part) {
    return MakePositions(
        part.joint_values, part.points,
        Eigen::Matrix3Xd::Constant(3, part.size(), kSigma).eval());
  };
  CalibrationTask task;
  task.arm = arm;
  task.data.training = data(fitted);
  task.options.identifiability.candidates = candidates;
  if (HasUnknownFrames(task) && !FitFrames(&task)) return kInfinity;
  const MeasurementModel model(task.arm);
  const IdentifiabilityOptions& options = task.options.identifiability;
  const Fit fit =
      FitPart(task, model, with_wide_priors ? WidenPriors(options) : options);
  if (!fit.summary.IsSolutionUsable()) return kInfinity;
  Eigen::VectorXd errors =
      (model.Predict(fit.values, others.joint_values) - others.points)
          .colwise()
          .norm();
  if (!errors.allFinite()) return kInfinity;
  double* const middle = errors.data() + errors.size() / 2;
  std::nth_element(errors.data(), middle, errors.data() + errors.size());
  return *middle;
}

}  // namespace alidade::internal
