#include "fit_report.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "alidade/base/chi_square.h"
#include "alidade/batch/evaluate.h"
#include "alidade/measurement/holdout.h"
#include "alidade/measurement/robust_loss.h"
#include "alidade/report/format.h"
#include "frame_fit.h"
#include "preparation.h"

namespace alidade {
namespace {

// Observations beyond this are outliers: were all residuals Gaussian, one of
// them would be there in so many of all calibrations.
constexpr double kChanceOfOutlier = 0.05;

// A parameter so many prior standard deviations away was not drawn from it.
constexpr double kFarFromPrior = 5.0;

StageResult MakeStage(const FinishedFit& fit, const std::string& name,
                      int num_free, const Eigen::VectorXd& values) {
  const MeasurementModel& model = fit.model();
  StageResult stage;
  stage.name = name;
  stage.num_free = num_free;
  stage.train = EvaluateAccuracy(model, fit.config.data, values);
  stage.train_rotation = EvaluateRotations(model, fit.config.data, values);
  if (fit.config.validation) {
    stage.heldout = EvaluateAccuracy(model, *fit.config.validation, values);
    stage.heldout_rotation =
        EvaluateRotations(model, *fit.config.validation, values);
  }
  return stage;
}

ObservationLabel LabelOf(const FinishedFit& fit, const ObservationBlock& block,
                         Eigen::Index i) {
  ObservationLabel label;
  label.kind = NameOf(block.kind);
  label.pose = -1;
  if (block.kind == MeasurementKind::kPointDistance) return label;
  label.pose = block.pose(i);
  label.target = fit.model().nominal().targets[block.target(i)].name;
  label.where = SourceOf(fit.config.data, label.pose);
  return label;
}

// Norms of the errors over all poses that were held out once.
struct PooledErrors {
  std::vector<double> lengths;
  std::vector<double> rotations;

  void Add(const MeasurementModel& model, const Dataset& data,
           const Eigen::VectorXd& values) {
    const Eigen::VectorXd errors = model.Errors(values, data);
    for (const double norm : LengthErrors(errors, data)) {
      lengths.push_back(norm);
    }
    for (const double norm : RotationErrors(errors, data)) {
      rotations.push_back(norm);
    }
  }

  static Accuracy Summarize(const std::vector<double>& norms) {
    return SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
        norms.data(), static_cast<Eigen::Index>(norms.size())));
  }
};

}  // namespace

std::vector<StageResult> ListStages(const FinishedFit& fit, int num_free) {
  const IdentifiabilityOptions& options = fit.config.identifiability;
  const Fit frames = FitOnce(fit.config, fit.model(), FramesOnly(options));
  std::vector<StageResult> stages = {MakeStage(
      fit, "frames only", frames.num_free(), fit.model().NominalValues())};
  if (!options.candidates.joints) return stages;
  const Fit offsets = FitOnce(fit.config, fit.model(),
                              OffsetsOnly(options, fit.config.arm));
  if (offsets.summary.IsSolutionUsable()) {
    stages.push_back(MakeStage(fit, "joint offsets", offsets.num_free(),
                               offsets.values));
  }
  stages.push_back(MakeStage(fit, "all geometry", num_free, fit.values));
  return stages;
}

std::vector<Outlier> ListOutliers(const FinishedFit& fit, double* limit) {
  const Dataset& data = fit.config.data;
  const Eigen::VectorXd errors = fit.model().Errors(fit.values, data);
  const Eigen::VectorXd squared = SquaredNorms(errors, data);
  const Eigen::VectorXd lengths = LengthErrors(errors, data);
  const double chance =
      kChanceOfOutlier / static_cast<double>(std::max<Eigen::Index>(
                             1, squared.size()));
  constexpr int kPositionRows = 3;
  *limit = std::sqrt(ChiSquareUpperQuantile(chance, kPositionRows));
  const std::vector<RobustLoss> losses = TunedLosses(fit.config.loss);
  std::vector<Outlier> outliers;
  Eigen::Index count = 0;
  for (const ObservationBlock& block : data.blocks) {
    for (Eigen::Index i = 0; i < block.size(); ++i, ++count) {
      const int rows = block.Dimension(i);
      if (rows == 0 ||
          squared[count] <= ChiSquareUpperQuantile(chance, rows)) {
        continue;
      }
      const double weight =
          losses.empty() ? 1.0 : losses[rows - 1].Weight(squared[count]);
      outliers.push_back({count, LabelOf(fit, block, i), lengths[count],
                          std::sqrt(squared[count]), weight});
    }
  }
  std::stable_sort(outliers.begin(), outliers.end(),
                   [](const Outlier& a, const Outlier& b) {
                     return a.standardised > b.standardised;
                   });
  return outliers;
}

std::optional<CrossValidation> CrossValidate(const JobConfig& config,
                                             int num_threads) {
  PooledErrors pooled;
  for (int k = 0; k < config.folds->folds; ++k) {
    JobConfig fold = config;
    HoldOut split =
        HoldOutFold(config.data, config.folds->folds, k, config.folds->seed);
    fold.data = std::move(split.train);
    FitFrames(&fold, num_threads);
    const MeasurementModel model(fold.arm, fold.references, num_threads);
    const Fit fit = FitOnce(fold, model, fold.identifiability);
    if (!fit.summary.IsSolutionUsable()) return std::nullopt;
    pooled.Add(model, split.heldout, fit.values);
  }
  return CrossValidation{config.folds->folds,
                         PooledErrors::Summarize(pooled.lengths),
                         PooledErrors::Summarize(pooled.rotations)};
}

double TypicalResidual(const FinishedFit& fit, double reduced_chi_square) {
  if (fit.config.loss == LossKind::kNone) return std::sqrt(reduced_chi_square);
  const Dataset& data = fit.config.data;
  const Eigen::VectorXd squared =
      SquaredNorms(fit.model().Errors(fit.values, data), data);
  const Eigen::VectorXi dimensions = Dimensions(data);
  std::vector<double> norms;
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    if (dimensions[i] == 0) continue;
    norms.push_back(std::sqrt(squared[i]) / MedianOfChi(dimensions[i]));
  }
  return RobustScale(std::move(norms), 1) * MedianOfChi(1);
}

std::string FarFromPriors(const FinishedFit& fit) {
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

std::string AtBounds(const FinishedFit& fit) {
  if (fit.problem.lower.size() == 0) return "";
  std::string names;
  for (const int column : fit.problem.free_columns) {
    const double value = fit.values[column];
    const bool inside = value > fit.problem.lower[column] &&
                        value < fit.problem.upper[column];
    if (inside) continue;
    names += (names.empty() ? "" : ", ") +
             fit.model().layout().parameter(column).name;
  }
  return names;
}

}  // namespace alidade
