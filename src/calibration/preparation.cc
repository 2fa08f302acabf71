#include "src/calibration/preparation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/calibration/sigma_change.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

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

}  // namespace

double TypicalResidual(const MeasurementModel& model, const Dataset& data,
                       const Eigen::VectorXd& values) {
  const SharedVector squared = SquaredNorms(model.Errors(values, data), data);
  std::vector<std::vector<double>> lists(data.blocks.size());
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < lists.size(); ++k) {
    for (Eigen::Index i = 0; i < data.blocks[k].size(); ++i, ++count) {
      const int dimension = data.blocks[k].Dimension(i);
      if (dimension == 0) continue;
      lists[k].push_back(std::sqrt(squared[count]) / MedianOfChi(dimension));
    }
  }
  std::vector<double> norms =
      InOrder(model.communicator(), data, std::move(lists));
  return ComputeOnRoot(model.communicator(), data, [&] {
    return RobustScale(std::move(norms), 1) * MedianOfChi(1);
  });
}

CalibrationProblem ProblemOf(const CalibrationTask& task,
                             const MeasurementModel& model,
                             const IdentifiabilityResult& pass) {
  CalibrationProblem problem{model, task.data.training, FreeColumns(pass),
                             pass.nominal_rank, PriorsOf(pass)};
  if (task.options.bounds.empty()) return problem;
  const double infinity = std::numeric_limits<double>::infinity();
  problem.lower.setConstant(model.layout().size(), -infinity);
  problem.upper.setConstant(model.layout().size(), infinity);
  for (const ParameterBounds& bounds : task.options.bounds) {
    const int column = *model.layout().Find(bounds.parameter);
    problem.lower[column] = bounds.lower;
    problem.upper[column] = bounds.upper;
  }
  return problem;
}

Fit FitOnce(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  Fit fit;
  fit.values = model.NominalValues();
  fit.identifiability =
      AnalyzeIdentifiability(model, task.data.training, options);
  const CalibrationProblem problem =
      ProblemOf(task, model, fit.identifiability);
  fit.summary =
      SolveRobust(problem, task.options.loss, task.options.solver_options,
                  &fit.values, task.start);
  return fit;
}

Fit FitPart(const CalibrationTask& task, const MeasurementModel& model,
            const IdentifiabilityOptions& options) {
  constexpr int kRounds = 2;
  CalibrationTask coarse = task;
  if (task.options.loss != LossKind::kNone) {
    coarse.options.loss = LossKind::kHuber;
  }
  Fit fit;
  fit.values = model.NominalValues();
  for (int round = 0; round < kRounds; ++round) {
    const double typical =
        TypicalResidual(model, task.data.training, fit.values);
    coarse.data.training = task.data.training;
    if (std::isfinite(typical)) {
      ScaleSigmas(std::max(1.0, typical), &coarse.data.training);
    }
    Fit next = FitOnce(coarse, model, options);
    if (!next.summary.IsSolutionUsable()) return next;
    fit = std::move(next);
  }
  return fit;
}

IdentifiabilityOptions WidenPriors(IdentifiabilityOptions options) {
  constexpr double kWider = 100.0;
  PriorTolerances& priors = options.priors;
  for (double* prior :
       {&priors.beta, &priors.alpha, &priors.d, &priors.theta, &priors.r}) {
    *prior *= kWider;
  }
  return options;
}

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

IdentifiabilityOptions OffsetsOnly(const IdentifiabilityOptions& options,
                                   const MeasurementModel& model) {
  const ParameterLayout& layout = model.layout();
  const Arm& arm = model.nominal();
  IdentifiabilityOptions offsets = FramesOnly(options, layout);
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

}  // namespace alidade::internal
