#include "src/calibration/fit_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "alidade/robust_loss.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/label_bytes.h"
#include "src/calibration/preparation.h"
#include "src/calibration/sigma_estimation.h"
#include "src/common/bytes.h"
#include "src/common/distributions.h"
#include "src/common/format.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/holdout.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Observations beyond this are outliers: were all residuals Gaussian, one of
// them would be there in so many of all calibrations.
constexpr double kChanceOfOutlier = 0.05;

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

void AppendTo(const SharedVector& norms, std::vector<double>* all) {
  all->insert(all->end(), norms.data(), norms.data() + norms.size());
}

Accuracy Summarize(const std::vector<double>& norms) {
  return SummarizeErrors(Eigen::Map<const Eigen::VectorXd>(
      norms.data(), static_cast<Eigen::Index>(norms.size())));
}

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

// Those of all ranks, on the root.
std::vector<Outlier> WithThoseOfOthers(Communicator* communicator,
                                       const Dataset& data,
                                       std::vector<Outlier> mine) {
  if (!data.partition) return mine;
  ByteWriter writer;
  for (const Outlier& outlier : mine) {
    writer.Put(outlier.observation);
    PutLabel(outlier.label, &writer);
    writer.Put(outlier.error);
    writer.Put(outlier.standardised);
    writer.Put(outlier.weight);
  }
  std::vector<Outlier> all;
  for (const std::string& bytes : communicator->GatherToRoot(writer.Take())) {
    ByteReader reader(bytes);
    while (!reader.is_at_end()) {
      Outlier outlier;
      outlier.observation = reader.Get<std::int64_t>();
      outlier.label = GetLabel(&reader);
      outlier.error = reader.Get<double>();
      outlier.standardised = reader.Get<double>();
      outlier.weight = reader.Get<double>();
      all.push_back(std::move(outlier));
    }
  }
  return all;
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

std::vector<Outlier> ListOutliers(const CalibrationSolution& fit,
                                  double* limit) {
  const Dataset& data = fit.task.data.training;
  const SharedVector errors = fit.model().Errors(fit.values, data);
  const SharedVector squared = SquaredNorms(errors, data);
  const SharedVector lengths = LengthErrors(errors, data);
  const double chance =
      kChanceOfOutlier / static_cast<double>(std::max<Eigen::Index>(
                             1, data.global_observations()));
  // Squared limits of observations of 0 to 6 rows.
  std::array<double, 7> limits{};
  for (std::size_t rows = 1; rows < limits.size(); ++rows) {
    limits[rows] = ChiSquareUpperQuantile(chance, static_cast<int>(rows));
  }
  constexpr int kPositionRows = 3;
  *limit = std::sqrt(limits[kPositionRows]);
  const std::vector<RobustLoss> losses = TunedLosses(fit.task.options.loss);
  std::vector<Outlier> outliers;
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < data.blocks.size(); ++k) {
    const ObservationBlock& block = data.blocks[k];
    for (Eigen::Index i = 0; i < block.size(); ++i, ++count) {
      const int rows = block.Dimension(i);
      if (rows == 0 || squared[count] <= limits[rows]) continue;
      const double weight =
          losses.empty() ? 1.0 : losses[rows - 1].Weight(squared[count]);
      outliers.push_back({GlobalObservation(data, k, i),
                          LabelOf(fit.model().nominal(), data, k, i),
                          lengths[count], std::sqrt(squared[count]), weight});
    }
  }
  outliers =
      WithThoseOfOthers(fit.task.communicator, data, std::move(outliers));
  std::stable_sort(outliers.begin(), outliers.end(),
                   [](const Outlier& a, const Outlier& b) {
                     if (a.standardised != b.standardised) {
                       return a.standardised > b.standardised;
                     }
                     return a.observation < b.observation;
                   });
  return outliers;
}

double ReducedChiSquare(const CalibrationSolution& fit) {
  const double freedom = DegreesOfFreedom(fit.problem, fit.values);
  if (freedom < 1.0) return 0.0;
  const Dataset& data = fit.task.data.training;
  const SharedVector squared =
      SquaredNorms(fit.model().Errors(fit.values, data), data);
  return SumInOrder(fit.task.communicator, data, squared) / freedom;
}

std::optional<CrossValidation> CrossValidate(const CalibrationTask& task) {
  std::vector<double> lengths;
  std::vector<double> rotations;
  for (int k = 0; k < task.options.folds->folds; ++k) {
    HoldOut split = HoldOutFold(task.data.training, task.options.folds->folds,
                                k, task.options.folds->seed);
    if (!CoversObjects(split)) return std::nullopt;
    CalibrationTask fold = task;
    fold.data.training = std::move(split.train);
    if (HasUnknownFrames(fold) && !fold.options.true_values &&
        !FitFrames(&fold)) {
      return std::nullopt;
    }
    if (fold.options.estimate_sigma && !(EstimateSigmas(&fold).length > 0.0)) {
      return std::nullopt;
    }
    const MeasurementModel model(fold.arm, fold.data.references,
                                 fold.execution());
    const Fit fit = FitOnce(fold, model, fold.options.identifiability);
    if (!fit.summary.IsSolutionUsable()) return std::nullopt;
    const SharedVector errors = model.Errors(fit.values, split.validation);
    for (const std::vector<double>& norms :
         CountedLengths(errors, split.validation)) {
      lengths.insert(lengths.end(), norms.begin(), norms.end());
    }
    AppendTo(RotationErrors(errors, split.validation), &rotations);
  }
  return CrossValidation{task.options.folds->folds, Summarize(lengths),
                         Summarize(rotations)};
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
