#include "preparation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "alidade/identifiability/analysis.h"
#include "alidade/identifiability/factor.h"
#include "alidade/identifiability/rules.h"
#include "alidade/measurement/frame_start.h"
#include "alidade/measurement/robust_loss.h"
#include "alidade/model/chain_axes.h"

namespace alidade {
namespace {

// The ratio of sigma to the priors settles in two or three rounds.
constexpr int kSigmaRounds = 4;

// A sigma below this is exact data, which have none.
constexpr double kSmallestSigma = 1e-12;

std::vector<std::string> WithoutJoints(const std::vector<std::string>& names) {
  std::vector<std::string> frames;
  for (const std::string& name : names) {
    if (name.rfind("base_", 0) == 0 || name.rfind("tool_", 0) == 0) {
      frames.push_back(name);
    }
  }
  return frames;
}

bool HoldsPartOfFrames(const IdentifiabilityOptions& options) {
  return !WithoutJoints(options.fix).empty();
}

std::vector<Eigen::Isometry3d> LastFrames(const Arm& arm,
                                          const Eigen::MatrixXd& joint_values) {
  Arm in_base = arm;
  in_base.instrument_from_base.setIdentity();
  std::vector<Eigen::Isometry3d> frames;
  frames.reserve(joint_values.cols());
  ChainAxes axes;
  for (Eigen::Index i = 0; i < joint_values.cols(); ++i) {
    ComputeChainAxes(in_base, joint_values.col(i).data(), &axes);
    frames.push_back(axes.instrument_from_last);
  }
  return frames;
}

// The arm with base, and tool where it is to be identified, as the data alone
// say; nothing where they do not.
std::optional<Arm> StartFrames(const JobConfig& config) {
  const std::vector<Eigen::Isometry3d> frames =
      LastFrames(config.arm, config.data.joint_values);
  Arm arm = config.arm;
  if (config.identifiability.candidates.tool) {
    const std::optional<PositionStart> start = StartFromPositions(
        frames, config.data.positions, std::vector<int>(frames.size(), 0), 1);
    if (!start) return std::nullopt;
    arm.instrument_from_base = start->instrument_from_base;
    arm.last_from_target().translation() = start->targets.col(0);
    return arm;
  }
  Eigen::Matrix3Xd points(3, config.data.num_poses());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    points.col(i) = frames[i] * arm.last_from_target().translation();
  }
  const std::optional<RigidFit> fit = FitRigid(points, config.data.positions);
  if (!fit) return std::nullopt;
  arm.instrument_from_base = fit->b_from_a;
  return arm;
}

double MedianError(const Arm& arm, const Dataset& data, int num_threads) {
  const MeasurementModel model(arm, num_threads);
  Eigen::VectorXd errors =
      model.Errors(model.NominalValues(), data).colwise().norm();
  std::nth_element(errors.data(), errors.data() + errors.size() / 2,
                   errors.data() + errors.size());
  return errors[errors.size() / 2];
}

double SigmaOfFit(const JobConfig& config, const CalibrationProblem& problem,
                  const Eigen::VectorXd& values) {
  const double freedom = DegreesOfFreedom(problem, values);
  if (!(freedom > 0.0)) return 0.0;
  const Eigen::VectorXd squared =
      SquaredNorms(problem.model.Errors(values, config.data), config.data);
  const double used = config.data.sigmas(0, 0);
  if (config.loss == LossKind::kNone) {
    return used * std::sqrt(squared.sum() / freedom);
  }
  const Eigen::VectorXd norms = squared.cwiseSqrt();
  const double scale = RobustScale(
      std::vector<double>(norms.data(), norms.data() + norms.size()), 3);
  const auto equations = static_cast<double>(config.data.num_rows());
  return used * scale * std::sqrt(equations / freedom);
}

}  // namespace

Fit FitOnce(const JobConfig& config, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  Fit fit;
  fit.values = model.NominalValues();
  fit.identifiability = AnalyzeIdentifiability(model, config.data, options);
  const CalibrationProblem problem{
      model, config.data, FreeColumns(fit.identifiability),
      fit.identifiability.nominal_rank, PriorsOf(fit.identifiability)};
  fit.summary =
      SolveRobust(problem, config.loss, config.solver_options, &fit.values);
  return fit;
}

IdentifiabilityOptions FramesOnly(const IdentifiabilityOptions& options) {
  IdentifiabilityOptions frames = options;
  frames.candidates.joints = false;
  frames.fix = WithoutJoints(options.fix);
  frames.free = WithoutJoints(options.free);
  frames.prefer = WithoutJoints(options.prefer);
  return frames;
}

IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const Arm& arm) {
  const ParameterLayout layout(arm.num_joints());
  IdentifiabilityOptions offsets = FramesOnly(options);
  offsets.candidates.joints = true;
  for (const Parameter& parameter : layout.parameters()) {
    if (!ParameterLayout::IsJointKind(parameter.kind)) continue;
    const bool revolute =
        arm.joints[parameter.index].type == JointType::kRevolute;
    if (parameter.kind ==
        (revolute ? ParameterKind::kTheta : ParameterKind::kR)) {
      continue;
    }
    offsets.fix.push_back(parameter.name);
  }
  for (const std::string& name : options.fix) {
    if (std::find(offsets.fix.begin(), offsets.fix.end(), name) ==
        offsets.fix.end()) {
      offsets.fix.push_back(name);
    }
  }
  return offsets;
}

bool FitFrames(JobConfig* config, int num_threads) {
  const CandidateGroups& groups = config->identifiability.candidates;
  if ((!groups.base && !groups.tool) || config->truth) return false;
  const Arm given = config->arm;
  if (groups.base && !HoldsPartOfFrames(config->identifiability)) {
    const std::optional<Arm> start = StartFrames(*config);
    if (start && MedianError(*start, config->data, num_threads) <
                     MedianError(given, config->data, num_threads)) {
      config->arm = *start;
    }
  }
  const MeasurementModel model(config->arm, num_threads);
  const Fit fit = FitOnce(*config, model, FramesOnly(config->identifiability));
  if (!fit.summary.IsSolutionUsable()) {
    config->arm = given;
    return false;
  }
  config->arm = model.layout().WithValues(config->arm, fit.values);
  return true;
}

double EstimateSigma(JobConfig* config, int num_threads) {
  const MeasurementModel model(config->arm, num_threads);
  double sigma = 0.0;
  for (int round = 0; round < kSigmaRounds; ++round) {
    const Fit fit = FitOnce(*config, model, config->identifiability);
    if (!fit.summary.IsSolutionUsable()) return 0.0;
    const CalibrationProblem problem{
        model, config->data, FreeColumns(fit.identifiability),
        fit.identifiability.nominal_rank, PriorsOf(fit.identifiability)};
    const double estimate = SigmaOfFit(*config, problem, fit.values);
    if (!(estimate > kSmallestSigma)) return 0.0;
    sigma = estimate;
    config->data.sigmas.setConstant(sigma);
    if (config->validation) config->validation->sigmas.setConstant(sigma);
  }
  return sigma;
}

double DegreesOfFreedom(const CalibrationProblem& problem,
                        const Eigen::VectorXd& values) {
  const std::vector<int>& free = problem.free_columns;
  const PoseSet poses{problem.data.joint_values, MeasurementKind::kPosition,
                      &problem.data.sigmas};
  const Eigen::MatrixXd factor =
      JacobianFactor(problem.model, values, poses, free);
  const auto equations = static_cast<double>(problem.data.num_rows());
  const auto p = static_cast<double>(free.size());
  if (problem.priors.size() == 0) return equations - p;
  // In units of the priors the matrix is I + J^T J, of eigenvalues from 1 on.
  Eigen::MatrixXd scaled = factor;
  for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
    scaled.col(k) *= problem.priors[free[k]];
  }
  const Eigen::MatrixXd normal =
      scaled.transpose() * scaled +
      Eigen::MatrixXd::Identity(scaled.cols(), scaled.cols());
  const Eigen::MatrixXd inverse = normal.llt().solve(
      Eigen::MatrixXd::Identity(scaled.cols(), scaled.cols()));
  return equations - (p - inverse.trace());
}

}  // namespace alidade
