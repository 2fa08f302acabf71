#include "src/calibration/fit_report.h"

#include <cmath>

#include "src/calibration/evaluate.h"
#include "src/calibration/preparation.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/format.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// A parameter so many prior standard deviations away was not drawn from it.
constexpr double kFarFromPrior = 5.0;

StageResult MakeStage(const CalibrationSolution& fit, const std::string& name,
                      int num_free, const Eigen::VectorXd& values) {
  const MeasurementModel& model = fit.model();
  StageResult stage;
  stage.name = name;
  stage.num_free = num_free;
  stage.train = EvaluateAccuracy(model, fit.task.data.training, values);
  stage.train_rotation =
      EvaluateRotations(model, fit.task.data.training, values);
  if (fit.task.data.validation) {
    stage.validation =
        EvaluateAccuracy(model, *fit.task.data.validation, values);
    stage.validation_rotation =
        EvaluateRotations(model, *fit.task.data.validation, values);
  }
  return stage;
}

}  // namespace

std::vector<StageResult> ListStages(const CalibrationSolution& fit,
                                    int num_free) {
  const IdentifiabilityOptions& options = fit.task.options.identifiability;
  const IdentifiabilityResult frames =
      AnalyzeIdentifiability(fit.model(), fit.task.data.training,
                             FramesOnly(options, fit.model().layout()));
  std::vector<StageResult> stages = {MakeStage(
      fit, "frames only", frames.num_free, fit.model().NominalValues())};
  if (!options.candidates.joints) return stages;
  const Fit offsets =
      FitPart(fit.task, fit.model(), OffsetsOnly(options, fit.model()));
  if (offsets.summary.IsSolutionUsable()) {
    stages.push_back(
        MakeStage(fit, "joint offsets", offsets.num_free(), offsets.values));
  }
  stages.push_back(MakeStage(fit, "all geometry", num_free, fit.values));
  return stages;
}

double ReducedChiSquare(const CalibrationSolution& fit, const Dataset& data) {
  const double freedom = DegreesOfFreedom(fit.problem, fit.values, data);
  if (freedom < 1.0) return 0.0;
  const SharedVector squared =
      SquaredNorms(fit.model().Errors(fit.values, data), data);
  return SumInOrder(fit.task.communicator, data, squared) / freedom;
}

std::string FarFromPriors(const CalibrationSolution& fit) {
  const Eigen::VectorXd nominal = fit.model().NominalValues();
  std::string names;
  for (const int column : fit.problem.ColumnsWithPrior()) {
    const double times = std::abs(fit.values[column] - nominal[column]) /
                         fit.problem.priors[column];
    if (times <= kFarFromPrior) continue;
    names += (names.empty() ? "" : ", ") +
             fit.model().layout().parameter(column).name + " (" +
             FormatSignificant(times, 2) + ")";
  }
  return names;
}

std::string AtBounds(const CalibrationSolution& fit) {
  if (fit.problem.lower.size() == 0) return "";
  std::string names;
  for (const int column : fit.problem.free_columns) {
    const double value = fit.values[column];
    const bool inside =
        value > fit.problem.lower[column] && value < fit.problem.upper[column];
    if (inside) continue;
    names += (names.empty() ? "" : ", ") +
             fit.model().layout().parameter(column).name;
  }
  return names;
}

}  // namespace alidade::internal
