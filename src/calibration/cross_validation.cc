#include "src/calibration/cross_validation.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "src/calibration/evaluate.h"
#include "src/calibration/flexible_fit.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/preparation.h"
#include "src/calibration/prepared_task.h"
#include "src/kernel/holdout.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

// Errors of poses left out of several fits.
class PooledErrors {
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

// The calibration of a task as it is made of all data: the errors of
// `held_out` after it. Nothing where no fit is usable.
std::optional<SharedVector> ErrorsLeftBy(CalibrationTask aligned,
                                         const Dataset& held_out) {
  const Prepared prepared = PrepareAligned(std::move(aligned));
  const CalibrationTask& task = prepared.task;
  const CalibrationOptions& options = task.options;
  if ((!prepared.frames_fitted && HasUnknownFrames(task) &&
       !options.true_values) ||
      (options.estimate_sigma && !(prepared.sigmas.length > 0.0)) ||
      (options.prior_scale == PriorScale::kEstimated &&
       !prepared.prior_scaling)) {
    return std::nullopt;
  }
  const MeasurementModel model(task.arm, task.data.references,
                               task.execution());
  const Fit rigid = FitOnce(task, model, options.identifiability);
  if (!rigid.summary.IsSolutionUsable()) return std::nullopt;
  if (options.errors.selection != ErrorTermSelection::kNone &&
      ErrorTermsObstacle(task).empty()) {
    const CalibrationProblem problem =
        ProblemOf(task, model, rigid.identifiability);
    ErrorTermsResult terms;
    std::vector<Finding> findings;
    const std::optional<FlexibleFit> fit =
        FitFlexible({task, problem, rigid.values}, &terms, &findings);
    if (fit) return fit->model->Errors(fit->values, held_out);
  }
  return model.Errors(rigid.values, held_out);
}

}  // namespace

std::optional<CrossValidation> CrossValidate(
    const CalibrationTask& task, const std::optional<Dataset>& kept) {
  PooledErrors all;
  PooledErrors without;
  const FoldsOptions& folds = *task.options.folds;
  for (int k = 0; k < folds.folds; ++k) {
    HoldOut split = HoldOutFold(task.data.training, folds.folds, k, folds.seed);
    if (!CoversObjects(split)) return std::nullopt;
    CalibrationTask fold = task;
    fold.data.training = std::move(split.train);
    fold.data.validation = std::move(split.validation);
    AlignStations(&fold);
    const Dataset held_out = *std::exchange(fold.data.validation, std::nullopt);
    const auto errors = ErrorsLeftBy(std::move(fold), held_out);
    if (!errors) return std::nullopt;
    all.Add(*errors, held_out);
    if (!kept) continue;
    without.Add(*errors,
                HoldOutFold(*kept, folds.folds, k, folds.seed).validation);
  }
  CrossValidation result{folds.folds, all.Positions(), all.Rotations()};
  if (kept) {
    result.kept = {all.size() - without.size(), without.Positions(),
                   without.Rotations()};
  }
  return result;
}

}  // namespace alidade::internal
