#include "alidade/batch/job.h"

#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/base/chi_square.h"
#include "alidade/base/version.h"
#include "alidade/batch/evaluate.h"
#include "alidade/identifiability/analysis.h"
#include "alidade/identifiability/rules.h"
#include "alidade/io/files.h"
#include "alidade/report/format.h"
#include "alidade/solve/solver.h"
#include "preparation.h"
#include "study.h"

namespace alidade {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

SolverRun Solve(SolverName name, const CalibrationProblem& problem,
                LossKind loss, const SolverOptions& options) {
  SolverRun run;
  run.values = problem.model.NominalValues();
  run.summary = name == SolverName::kCeres
                    ? SolveRobust(problem, loss, options, &run.values)
                    : SolvePseudoInverse(problem, options, &run.values);
  run.train = EvaluateAccuracy(problem.model, problem.data, run.values);
  return run;
}

// Residuals of so many sigmas in the root mean square are no chance: with ten
// degrees of freedom the odds are below 1e-6.
constexpr double kLargeResiduals = 2.5;

// A parameter so many prior standard deviations away was not drawn from it.
constexpr double kFarFromPrior = 5.0;

std::vector<AcceptanceCheck> CheckAcceptance(const AcceptanceLimits& limits,
                                             const JobResult& result) {
  std::vector<AcceptanceCheck> checks;
  const auto add = [&](const char* quantity, const std::optional<double>& limit,
                       double obtained) {
    if (limit) checks.push_back({quantity, *limit, obtained});
  };
  add("train_rms", limits.train_rms, result.train.after.rms);
  add("train_max", limits.train_max, result.train.after.max);
  if (result.heldout) {
    add("heldout_rms", limits.heldout_rms, result.heldout->after.rms);
    add("heldout_max", limits.heldout_max, result.heldout->after.max);
  }
  return checks;
}

// Observations beyond this are outliers: were all residuals Gaussian, one of
// them would be there in so many of all calibrations.
constexpr double kChanceOfOutlier = 0.05;

constexpr int kPositionDimension = 3;

class JobRunner {
 public:
  JobRunner(JobConfig config, int num_threads)
      : config_(std::move(config)),
        frames_fitted_(FitFrames(&config_, num_threads)),
        estimated_sigma_(config_.estimate_sigma
                             ? EstimateSigma(&config_, num_threads)
                             : 0.0),
        model_(config_.arm, num_threads) {
    outcome_.calibrated = config_.arm;
  }

  JobOutcome Run(const std::string& command) {
    DescribeInputs(command);
    result().estimated_sigma = estimated_sigma_;
    if (config_.estimate_sigma && !(estimated_sigma_ > 0.0)) {
      outcome_.status = JobStatus::kRefused;
      outcome_.message =
          "sigma cannot be estimated: these poses leave no degree of freedom, "
          "or the data are exact, or no fit succeeded. State `measurement: "
          "{sigma: ...}`";
      return std::move(outcome_);
    }
    if (frames_fitted_) {
      result().before_note =
          "before: base and tool fitted to the training poses, the geometry of "
          "the joints nominal";
    }
    if (Identify() && SolveAll()) Evaluate();
    outcome_.result.total_time_s = SecondsSince(start_);
    return std::move(outcome_);
  }

 private:
  JobResult& result() { return outcome_.result; }

  void DescribeInputs(const std::string& command) {
    result().version = Version();
    result().command = command;
    result().title = config_.title;
    result().arm = config_.arm.name;
    result().seed = config_.identifiability.seed;
    for (const std::string& path : config_.input_files) {
      result().inputs.push_back({path, Sha256(ReadFile(path))});
    }
  }

  bool Identify() {
    const auto begin = std::chrono::steady_clock::now();
    result().identifiability =
        AnalyzeIdentifiability(model_, config_.data, config_.identifiability);
    result().identify_time_s = SecondsSince(begin);
    for (const std::string& warning : result().identifiability.warnings) {
      LOG(WARNING) << "warning: " << warning;
    }
    if (result().identifiability.exceeds_rank &&
        !config_.identifiability.proceed_beyond_rank) {
      outcome_.status = JobStatus::kRefused;
      outcome_.message = result().identifiability.refusal;
      return false;
    }
    return true;
  }

  bool SolveAll() {
    SolverOptions options = config_.solver_options;
    options.num_threads = model_.num_threads();
    problem_.emplace(CalibrationProblem{model_, config_.data,
                                        FreeColumns(result().identifiability),
                                        result().identifiability.nominal_rank,
                                        PriorsOf(result().identifiability)});
    result().runs.push_back(
        Solve(config_.solver, *problem_, config_.loss, options));
    const SolverSummary& summary = result().runs.front().summary;
    if (!summary.IsSolutionUsable()) {
      outcome_.status = JobStatus::kFailed;
      outcome_.message = "the solver " + summary.solver + " " +
                         ToString(summary.status) + ": " + summary.message;
      return false;
    }
    for (const SolverName other : config_.compare_with) {
      if (other == config_.solver) continue;
      result().runs.push_back(
          Solve(other, *problem_, LossKind::kNone, options));
    }
    return true;
  }

  void Evaluate() {
    const Eigen::VectorXd nominal = model_.NominalValues();
    const Eigen::VectorXd& values = result().runs.front().values;
    outcome_.calibrated = model_.layout().WithValues(config_.arm, values);
    ListParameters(nominal, values);
    result().train = EvaluateSet(model_, config_.data, nominal, values);
    if (config_.validation) {
      result().heldout =
          EvaluateSet(model_, *config_.validation, nominal, values);
    }
    if (config_.published) {
      result().study = CompareWithStudy({config_, *problem_, result()});
    }
    ListStages(nominal, values);
    ListOutliers();
    DoubtResult(values - nominal);
    result().acceptance = CheckAcceptance(config_.acceptance, result());
    outcome_.status = JobStatus::kDone;
    if (!result().accepted()) {
      outcome_.status = JobStatus::kMissedLimits;
      outcome_.message = "an acceptance limit is missed";
    }
  }

  void Warn(const std::string& warning) {
    result().warnings.push_back(warning);
    LOG(WARNING) << "warning: " << warning;
  }

  // A solver's minimum may be a bad one: of wrong data, of a wrong arm, or not
  // reached at all.
  void DoubtResult(const Eigen::VectorXd& deviations) {
    const SolverSummary& summary = result().runs.front().summary;
    if (summary.status == SolverStatus::kIterationLimit) {
      Warn("the solver " + summary.solver +
           " was stopped by the number of iterations and may be far from the "
           "minimum");
    }
    const double freedom =
        DegreesOfFreedom(*problem_, result().runs.front().values);
    if (freedom >= 1.0) {
      result().reduced_chi_square =
          ChiSquare(result().train.residual_after, config_.data) / freedom;
    }
    const double ratio = TypicalResidual();
    if (ratio > kLargeResiduals) {
      Warn("the residuals are " + FormatSignificant(ratio, 3) +
           " times as large as the sigmas say: look for wrong units, columns, "
           "outliers, sigmas or a wrong arm");
    }
    DoubtPriors(deviations);
  }

  // In sigmas: the root mean square, or, where the loss expects outliers, what
  // the median of the norms says.
  double TypicalResidual() {
    if (config_.loss == LossKind::kNone) {
      return std::sqrt(result().reduced_chi_square);
    }
    const Eigen::VectorXd squared =
        SquaredNorms(result().train.residual_after, config_.data);
    std::vector<double> norms;
    for (const double s : squared) norms.push_back(std::sqrt(s));
    return RobustScale(std::move(norms), kPositionDimension);
  }

  void AddStage(const std::string& name, int num_free,
                const Eigen::VectorXd& values) {
    StageResult stage;
    stage.name = name;
    stage.num_free = num_free;
    stage.train = EvaluateAccuracy(model_, config_.data, values);
    if (config_.validation) {
      stage.heldout = EvaluateAccuracy(model_, *config_.validation, values);
    }
    result().stages.push_back(std::move(stage));
  }

  // What each part brings. Only where frames are fitted is the first of them
  // something else than the arm as it was given.
  void ListStages(const Eigen::VectorXd& nominal,
                  const Eigen::VectorXd& values) {
    if (!frames_fitted_) return;
    const IdentifiabilityOptions& options = config_.identifiability;
    const Fit frames = FitOnce(config_, model_, FramesOnly(options));
    AddStage("frames only", frames.num_free(), nominal);
    if (!options.candidates.joints) return;
    const Fit offsets =
        FitOnce(config_, model_, OffsetsOnly(options, config_.arm));
    if (offsets.summary.IsSolutionUsable()) {
      AddStage("joint offsets", offsets.num_free(), offsets.values);
    }
    AddStage("all geometry", result().identifiability.num_free, values);
  }

  void ListOutliers() {
    const Eigen::VectorXd squared =
        SquaredNorms(result().train.residual_after, config_.data);
    const auto count = static_cast<double>(squared.size());
    result().outlier_limit = std::sqrt(
        ChiSquareUpperQuantile(kChanceOfOutlier / count, kPositionDimension));
    const RobustLoss loss{
        config_.loss, config_.loss == LossKind::kNone
                          ? 1.0
                          : TuningConstant(config_.loss, kPositionDimension)};
    for (Eigen::Index i = 0; i < squared.size(); ++i) {
      const double norm = std::sqrt(squared[i]);
      if (norm <= result().outlier_limit) continue;
      result().outliers.push_back({i,
                                   result().train.residual_after.col(i).norm(),
                                   norm, loss.Weight(squared[i])});
    }
    std::stable_sort(result().outliers.begin(), result().outliers.end(),
                     [](const Outlier& a, const Outlier& b) {
                       return a.standardised > b.standardised;
                     });
  }

  void DoubtPriors(const Eigen::VectorXd& deviations) {
    std::string names;
    for (const int column : problem_->ColumnsWithPrior()) {
      const double times =
          std::abs(deviations[column]) / problem_->priors[column];
      if (times <= kFarFromPrior) continue;
      names += (names.empty() ? "" : ", ") +
               model_.layout().parameter(column).name + " (" +
               FormatSignificant(times, 2) + ")";
    }
    if (names.empty()) return;
    Warn(
        "further from nominal than the priors allow, in standard deviations: " +
        names +
        "; correct the nominal arm, widen the priors or use another "
        "policy");
  }

  void ListParameters(const Eigen::VectorXd& nominal,
                      const Eigen::VectorXd& values) {
    const ParameterLayout& layout = model_.layout();
    for (const ParameterBlock& block : layout.blocks()) {
      for (int i = 0; i < block.size; ++i) {
        const int column = block.first_column + i;
        ParameterResult parameter;
        parameter.name = layout.parameter(column).name;
        parameter.kind = block.name;
        parameter.dimension = layout.parameter(column).dimension;
        parameter.nominal = nominal[column];
        parameter.value = values[column];
        if (config_.truth) parameter.truth = (*config_.truth)[column];
        parameter.decision = result().identifiability.decisions[column];
        result().parameters.push_back(std::move(parameter));
      }
    }
  }

  const std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
  JobConfig config_;
  const bool frames_fitted_;
  const double estimated_sigma_;
  MeasurementModel model_;
  std::optional<CalibrationProblem> problem_;
  JobOutcome outcome_;
};

}  // namespace

JobOutcome RunJob(const JobConfig& config, const std::string& command,
                  int num_threads) {
  return JobRunner(config, num_threads).Run(command);
}

IdentifiabilityResult IdentifyJob(const JobConfig& config, int num_threads) {
  JobConfig prepared = config;
  FitFrames(&prepared, num_threads);
  const MeasurementModel model(prepared.arm, num_threads);
  return AnalyzeIdentifiability(model, prepared.data, prepared.identifiability);
}

}  // namespace alidade
