#include "src/calibration/fit_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "src/calibration/evaluate.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/preparation.h"
#include "src/calibration/prior_scale.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/format.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/holdout.h"
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

// Errors of poses left out of several fits.
class Errors {
 public:
  void Add(const SharedVector& errors, const Dataset& data) {
    for (const std::vector<double>& norms : CountedLengths(errors, data)) {
      lengths_.insert(lengths_.end(), norms.begin(), norms.end());
    }
    const SharedVector norms = RotationErrors(errors, data);
    rotations_.insert(rotations_.end(), norms.data(),
                      norms.data() + norms.size());
  }
  Accuracy Positions() const { return Summarize(lengths_); }
  Accuracy Rotations() const { return Summarize(rotations_); }
  std::int64_t size() const {
    return static_cast<std::int64_t>(
        std::max(lengths_.size(), rotations_.size()));
  }

 private:
  static Accuracy Summarize(const std::vector<double>& norms) {
    return SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
        norms.data(), static_cast<Eigen::Index>(norms.size())));
  }

  std::vector<double> lengths_;
  std::vector<double> rotations_;
};

// Targets, points and planes that data say something of, as names.
std::set<std::string> ObjectsIn(const Dataset& data) {
  std::set<std::string> objects;
  for (const ObservationBlock& block : data.blocks) {
    const bool is_plane = block.kind == MeasurementKind::kPlane;
    for (Eigen::Index i = 0; i < block.size(); ++i) {
      objects.insert("target " + std::to_string(block.target(i)));
      if (block.references.empty()) continue;
      objects.insert((is_plane ? "plane " : "point ") +
                     std::to_string(block.references[i]));
    }
  }
  return objects;
}

bool CoversObjects(const HoldOut& split) {
  const std::set<std::string> train = ObjectsIn(split.train);
  const std::set<std::string> validation = ObjectsIn(split.validation);
  return std::includes(train.begin(), train.end(), validation.begin(),
                       validation.end());
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

std::optional<CrossValidation> CrossValidate(
    const CalibrationTask& task, const std::optional<Dataset>& kept) {
  Errors all;
  Errors without;
  const FoldsOptions& folds = *task.options.folds;
  for (int k = 0; k < folds.folds; ++k) {
    HoldOut split = HoldOutFold(task.data.training, folds.folds, k, folds.seed);
    if (!CoversObjects(split)) return std::nullopt;
    CalibrationTask fold = task;
    fold.data.training = std::move(split.train);
    if (HasUnknownFrames(fold) && !fold.options.true_values &&
        !FitFrames(&fold)) {
      return std::nullopt;
    }
    const CalibrationTask as_stated = fold;
    if (fold.options.estimate_sigma && !(EstimateSigmas(&fold).length > 0.0)) {
      return std::nullopt;
    }
    EstimatedSigmas sigmas;
    if (fold.options.prior_scale == PriorScale::kEstimated &&
        !EstimatePriors(as_stated, &fold, &sigmas)) {
      return std::nullopt;
    }
    const MeasurementModel model(fold.arm, fold.data.references,
                                 fold.execution());
    const Fit fit = FitOnce(fold, model, fold.options.identifiability);
    if (!fit.summary.IsSolutionUsable()) return std::nullopt;
    const SharedVector errors = model.Errors(fit.values, split.validation);
    all.Add(errors, split.validation);
    if (!kept) continue;
    without.Add(errors,
                HoldOutFold(*kept, folds.folds, k, folds.seed).validation);
  }
  CrossValidation result{folds.folds, all.Positions(), all.Rotations()};
  if (kept) {
    result.kept = {all.size() - without.size(), without.Positions(),
                   without.Rotations()};
  }
  return result;
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
