#include "alidade/calibration.h"

#include <glog/logging.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/version.h"
#include "src/calibration/acceptance.h"
#include "src/calibration/calibration_task.h"
#include "src/calibration/cross_validation.h"
#include "src/calibration/data_check.h"
#include "src/calibration/error_term_report.h"
#include "src/calibration/evaluate.h"
#include "src/calibration/fit_report.h"
#include "src/calibration/fit_uncertainty.h"
#include "src/calibration/fit_warnings.h"
#include "src/calibration/flexible_fit.h"
#include "src/calibration/frame_fit.h"
#include "src/calibration/identifiability_cache.h"
#include "src/calibration/orientation_check.h"
#include "src/calibration/outliers.h"
#include "src/calibration/own_references.h"
#include "src/calibration/pose_performance.h"
#include "src/calibration/preparation.h"
#include "src/calibration/prepared_task.h"
#include "src/calibration/rejection.h"
#include "src/calibration/sigma_change.h"
#include "src/calibration/sigma_estimation.h"
#include "src/calibration/station_frames.h"
#include "src/calibration/verdict.h"
#include "src/common/format.h"
#include "src/common/names.h"
#include "src/common/text.h"
#include "src/identifiability/analysis.h"
#include "src/kernel/partition.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

SolverRun Solve(SolverName name, const CalibrationProblem& problem,
                LossKind loss, const SolverOptions& options,
                const Eigen::VectorXd& start = {}) {
  SolverRun run;
  run.values = problem.model.NominalValues();
  run.summary = name == SolverName::kCeres
                    ? SolveRobust(problem, loss, options, &run.values, start)
                    : SolvePseudoInverse(problem, options, &run.values);
  run.train = EvaluateAccuracy(problem.model, problem.data, run.values);
  return run;
}

/// One calibration: from the prepared task to the result, step by step.
class Calibrator {
 public:
  /// `as_given`: the task before its preparation, for what repeats all of it;
  /// may be null where there are no folds.
  Calibrator(Prepared prepared, const CalibrationTask* as_given,
             IdentifiabilityCache* cache)
      : prepared_(std::move(prepared)),
        as_given_(as_given),
        cache_(cache),
        model_(task().arm, task().data.references, task().execution()) {
    result_.arm = task().arm;
  }

  /// `note`: what else was done to the data; may be empty.
  CalibrationResult Run(const std::string& note) {
    DescribeData();
    if (!note.empty()) AddWarning(note, &result_);
    if (prepared_.misfit) AddWarning(*prepared_.misfit, &result_);
    WarnOfDistances();
    if (task().options.estimate_sigma && !(prepared_.sigmas.length > 0.0)) {
      Fail(CalibrationStatus::kRefused,
           "sigma is unknown and cannot be estimated: these poses leave fewer "
           "than three degrees of freedom, or the data are exact, or no fit "
           "succeeded. Measure more poses, or state `measurement: {sigma: "
           "...}`");
      return std::move(result_);
    }
    if (prepared_.frames_fitted) {
      const References& references = task().data.references;
      const bool has_references =
          references.num_points() + references.num_planes() > 0;
      const auto& candidates = task().options.identifiability.candidates;
      std::vector<std::string> frames;
      if (candidates.base) frames.emplace_back("base");
      if (candidates.tool) frames.emplace_back("tool");
      if (has_references) frames.emplace_back("points and planes");
      result_.before_note =
          "before: " + Join(frames, ", ") +
          " fitted to the training poses, the geometry of the joints nominal";
    }
    if (prepared_.frames_fitted) RequireOrientationsNearby(model_, task());
    if (Identify() && SolveAll()) {
      RequireOrientationsFit(model_, task(), result_.runs.front().values);
      Evaluate();
    }
    JudgeResult(&result_);
    return std::move(result_);
  }

 private:
  const CalibrationTask& task() const { return prepared_.task; }

  void Fail(CalibrationStatus status, std::string message) {
    result_.status = status;
    result_.message = std::move(message);
  }

  void DescribeRepeats(const Dataset& data) {
    result_.repeats =
        MeasureRepeats(data, task().communicator, task().options.errors.uses);
    measurement_.repeat_std = result_.repeats.length;
    measurement_.repeat_freedom =
        static_cast<double>(result_.repeats.length_degrees_of_freedom);
  }

  void DescribeData() {
    const Dataset& data = task().data.training;
    result_.version = Version();
    result_.arm_name = task().arm.name;
    result_.seed = task().options.identifiability.seed;
    result_.sigma = MedianLengthSigma(data, task().communicator);
    result_.estimated_sigma = prepared_.sigmas.length;
    result_.estimated_rotation_sigma = prepared_.sigmas.rotation;
    result_.prior_scaling = prepared_.prior_scaling;
    DescribeRepeats(data);
    const std::vector<std::string> small = SmallStations(task());
    if (!small.empty()) {
      AddWarning("fewer than three training poses were measured from " +
                     JoinNames(small) +
                     ": its base cannot be found from them. Leave these rows "
                     "out (`exclude`), or measure more there",
                 &result_);
    }
    if (prepared_.stated_noise && result_.sigma > 0.0) {
      measurement_.stated_sigma =
          result_.sigma * std::sqrt(prepared_.stated_noise->front());
    }
    const auto add = [&](const std::string& block, const std::string& name) {
      if (!name.empty()) result_.aliases.emplace_back(block, name);
    };
    int number = 0;
    for (const Target& target : task().arm.targets) {
      ++number;
      add(number == 1 ? "tool" : "tool" + std::to_string(number), target.name);
    }
    number = 0;
    for (const ReferencePoint& point : task().data.references.points) {
      add("point" + std::to_string(++number), point.name);
    }
    number = 0;
    for (const ReferencePlane& plane : task().data.references.planes) {
      add("plane" + std::to_string(++number), plane.name);
    }
  }

  void WarnOfDistances() {
    const double factor = prepared_.sigmas.distance_factor;
    if (factor == 1.0) return;
    AddWarning(
        "the measurements contradict the known distances between points: "
        "these were given " +
            FormatSignificant(factor, 2) +
            " times the standard deviations that were stated. Check the "
            "distances, and look for errors of the arm that its parameters do "
            "not describe",
        &result_);
  }

  bool Identify() {
    const auto begin = std::chrono::steady_clock::now();
    const IdentifiabilityOptions& options = task().options.identifiability;
    result_.identifiability =
        cache_ == nullptr
            ? AnalyzeIdentifiability(model_, task().data.training, options)
            : cache_->Analyze(model_, task().data.training, options);
    result_.identify_time_s = SecondsSince(begin);
    if (!result_.identifiability.exceeds_rank || options.proceed_beyond_rank) {
      return true;
    }
    Fail(CalibrationStatus::kRefused, result_.identifiability.refusal);
    return false;
  }

  bool SolveAll() {
    SolverOptions options = task().options.solver_options;
    options.num_threads = model_.num_threads();
    problem_.emplace(ProblemOf(task(), model_, result_.identifiability));
    result_.runs.push_back(Solve(task().options.solver, *problem_,
                                 task().options.loss, options, task().start));
    const SolverSummary& summary = result_.runs.front().summary;
    if (!summary.IsSolutionUsable()) {
      Fail(CalibrationStatus::kFailed, "the solver " + summary.solver + " " +
                                           ToString(summary.status) + ": " +
                                           summary.message);
      return false;
    }
    for (const SolverName other : task().options.compare_with) {
      if (other == task().options.solver) continue;
      result_.runs.push_back(Solve(other, *problem_, LossKind::kNone, options));
    }
    return true;
  }

  // The model that describes the result.
  const MeasurementModel& fitted() const {
    return flexible_ ? *flexible_->model : model_;
  }

  void FitErrors(const CalibrationSolution& rigid) {
    if (task().options.errors.selection == ErrorTermSelection::kNone) return;
    ErrorTermsResult& errors = result_.error_terms.emplace();
    const std::string obstacle = ErrorTermsObstacle(task());
    if (!obstacle.empty()) {
      errors.sentence = "no error terms: " + obstacle;
      AddWarning(errors.sentence, &result_);
      return;
    }
    std::vector<Finding> findings;
    flexible_ = FitFlexible(rigid, &errors, &findings);
    for (const Finding& finding : findings) AddWarning(finding, &result_);
    if (!flexible_) return;
    if (task().options.estimate_sigma) {
      MatchSigmas(fitted(), flexible_->values, errors.effective_terms,
                  &prepared_.task);
      result_.sigma =
          MedianLengthSigma(task().data.training, task().communicator);
      result_.estimated_sigma = result_.sigma;
      result_.estimated_rotation_sigma = MedianSigma(
          RowClass::kRotation, task().data.training, task().communicator);
    }
    flexible_problem_.emplace(
        ProblemOf(task(), fitted(), result_.identifiability));
  }

  bool HasRepeats() const {
    return result_.repeats.length_degrees_of_freedom > 0 ||
           result_.repeats.rotation_degrees_of_freedom > 0;
  }

  void Evaluate() {
    const Eigen::VectorXd nominal = model_.NominalValues();
    const CalibrationSolution rigid{task(), *problem_,
                                    result_.runs.front().values};
    if (prepared_.frames_fitted) {
      result_.stages = ListStages(rigid, result_.identifiability.num_free);
    }
    FitErrors(rigid);
    const Eigen::VectorXd& values =
        flexible_ ? flexible_->values : rigid.values;
    SetArm(values);
    ListParameters(nominal, values);
    ListReferences(model_.ReferencesAt(values));
    const CalibrationSolution fit{
        task(), flexible_problem_ ? *flexible_problem_ : *problem_, values,
        flexible_ ? flexible_->covariance : nullptr};
    covariance_ = CovarianceOfFit(fit, {task().options.estimate_sigma,
                                        prepared_.stated_noise, HasRepeats()});
    FindAllOutliers(fit);
    EvaluateSets(nominal, values);
    DescribePosePerformance();
    if (task().options.folds) {
      result_.cross_validation = CrossValidate(*as_given_, training_.kept);
      if (!result_.cross_validation) {
        AddWarning(
            "cross-validation found no usable fit of one of its folds, or one "
            "that leaves no pose to a point, plane or target: other folds "
            "leave more",
            &result_);
      }
    }
    result_.reduced_chi_square = ReducedChiSquare(
        fit, training_.kept ? *training_.kept : problem_->data);
    WarnOfFit(fit,
              {prepared_.frames_fitted, prepared_.sigmas.is_bound,
               prepared_.sigmas.has_two_groups, prepared_.misfit.has_value()},
              &result_);
    Assess(fit);
    if (flexible_) DescribeErrorTerms(rigid, fit, &result_);
    Accept(fit);
  }

  // Its terms take moments of its own geometry.
  void SetArm(const Eigen::VectorXd& values) {
    result_.arm = model_.layout().WithValues(fitted().nominal(), values);
    result_.arm.errors.load_geometry.resize(0, 0);
    RestoreStations(prepared_.stations, &result_.arm);
  }

  void FindAllOutliers(const CalibrationSolution& fit) {
    training_ = FindOutliers(fit);
    result_.outliers = training_.outliers;
    result_.outlier_limit = training_.limit;
    if (training_.kept) DescribeRepeats(*training_.kept);
    for (SolverRun& run : result_.runs) {
      CountKeptAlone(fit, training_, &run.summary);
    }
    if (!task().data.validation) return;
    validation_ =
        FindValidationOutliers(fit, training_, covariance_.lack.prediction);
    result_.validation_outliers = validation_.outliers;
  }

  EvaluatedSet EvaluateWith(const OutlierSearch& found, const Dataset& data,
                            const Eigen::VectorXd& nominal,
                            const Eigen::VectorXd& values) const {
    EvaluatedSet set = EvaluateSet(model_, nominal, fitted(), values, data,
                                   found.kept ? &*found.kept : nullptr);
    if (set.kept) set.kept->num_rejected = found.num_rejected;
    return set;
  }

  void EvaluateSets(const Eigen::VectorXd& nominal,
                    const Eigen::VectorXd& values) {
    const CalibrationData& data = task().data;
    result_.train = EvaluateWith(training_, data.training, nominal, values);
    if (!data.validation) return;
    result_.validation =
        EvaluateWith(validation_, *data.validation, nominal, values);
    // Without orientations in the fit nothing determines the target's own.
    if (!data.training.Has(MeasurementKind::kPose)) {
      result_.validation->rotation_before = {};
      result_.validation->rotation_after = {};
      if (result_.validation->kept) {
        result_.validation->kept->rotation_before = {};
        result_.validation->kept->rotation_after = {};
      }
    }
  }

  void DescribePosePerformance() {
    const auto add = [&](const char* poses, const EvaluatedSet& set,
                         const std::vector<Outlier>& outliers) {
      if (auto found = MeasurePosePerformance(poses, set, outliers)) {
        result_.pose_performance.push_back(*std::move(found));
      }
    };
    if (HasRepeats()) add("training", result_.train, result_.outliers);
    if (result_.validation) {
      add("validation", *result_.validation, result_.validation_outliers);
    }
  }

  void Assess(const CalibrationSolution& fit) {
    result_.uncertainty = AssessFit(
        fit, result_.identifiability, result_.runs.front().summary.final_cost,
        {training_, validation_, covariance_, measurement_});
    for (const ParameterUncertainty& one : result_.uncertainty->parameters) {
      result_.parameters[*model_.layout().Find(one.name)].std = one.std;
    }
    for (const std::string& warning : result_.uncertainty->warnings) {
      AddWarning(warning, &result_);
    }
  }

  void Accept(const CalibrationSolution& fit) {
    result_.acceptance = CheckAcceptance(task().options.acceptance, result_);
    result_.status = CalibrationStatus::kDone;
    const std::string reason =
        ReasonToReject(fit, prepared_.frames_fitted, result_);
    if (!reason.empty()) {
      Fail(CalibrationStatus::kFailed, reason);
    } else if (!result_.accepted()) {
      Fail(CalibrationStatus::kMissedLimits,
           "acceptance limits missed: " + MissedLimits(result_));
    }
  }

  void ListReferences(const References& references) {
    int number = 0;
    for (const ReferencePoint& point : references.points) {
      ReferenceResult reference;
      reference.block = "point" + std::to_string(++number);
      reference.name = point.name;
      reference.is_known = point.is_known;
      reference.vector = point.position;
      result_.references.push_back(reference);
    }
    number = 0;
    for (const ReferencePlane& plane : references.planes) {
      ReferenceResult reference;
      reference.block = "plane" + std::to_string(++number);
      reference.name = plane.name;
      reference.is_known = plane.is_known;
      reference.vector = plane.normal;
      reference.offset = plane.offset;
      result_.references.push_back(reference);
    }
  }

  void ListParameters(const Eigen::VectorXd& nominal,
                      const Eigen::VectorXd& values) {
    const ParameterLayout& layout = model_.layout();
    const std::optional<Eigen::VectorXd>& truth = task().options.true_values;
    for (const ParameterBlock& block : layout.blocks()) {
      for (int i = 0; i < block.size; ++i) {
        const int column = block.first_column + i;
        ParameterResult parameter;
        parameter.name = layout.parameter(column).name;
        parameter.kind = block.name;
        parameter.dimension = layout.parameter(column).dimension;
        parameter.nominal = nominal[column];
        parameter.value = values[column];
        const ParameterKind kind = layout.parameter(column).kind;
        if (truth && !ParameterLayout::IsReferenceKind(kind)) {
          parameter.truth = (*truth)[column];
        }
        parameter.decision = result_.identifiability.decisions[column];
        result_.parameters.push_back(std::move(parameter));
      }
    }
  }

  Prepared prepared_;
  const CalibrationTask* const as_given_;
  IdentifiabilityCache* const cache_;
  const MeasurementModel model_;
  std::optional<CalibrationProblem> problem_;
  std::optional<FlexibleFit> flexible_;
  std::optional<CalibrationProblem> flexible_problem_;
  FitCovariance covariance_;
  MeasurementKnowledge measurement_;
  OutlierSearch training_;
  OutlierSearch validation_;
  CalibrationResult result_;
};

}  // namespace

CalibrationResult Calibrate(CalibrationTask task, IdentifiabilityCache* cache) {
  const auto start = std::chrono::steady_clock::now();
  CheckAndHoldOut(&task);
  const std::string own_references = FitOwnReferences(&task);
  std::optional<CalibrationTask> as_given;
  if (task.options.folds) as_given = task;
  CalibrationResult result = Calibrator(Prepare(std::move(task)),
                                        as_given ? &*as_given : nullptr, cache)
                                 .Run(own_references);
  result.total_time_s = SecondsSince(start);
  return result;
}

IdentifiabilityResult AnalyzeTask(CalibrationTask task) {
  CheckAndHoldOut(&task);
  HoldOwnReferences(&task);
  AlignStations(&task);
  RefuseMistakes(task);
  FitFrames(&task);
  const MeasurementModel model(task.arm, task.data.references,
                               task.execution());
  return AnalyzeIdentifiability(model, task.data.training,
                                task.options.identifiability);
}

}  // namespace alidade::internal

namespace alidade {

CalibrationResult Calibrate(const Arm& arm, const CalibrationData& data,
                            const CalibrationOptions& options) {
  internal::RequireMeasurements(data.training);
  return internal::Calibrate({arm, data, options});
}

IdentifiabilityResult AnalyzeIdentifiability(
    const Arm& arm, const CalibrationData& data,
    const CalibrationOptions& options) {
  return internal::AnalyzeTask({arm, data, options});
}

}  // namespace alidade
