#include "alidade/batch/job.h"

#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "alidade/base/version.h"
#include "alidade/batch/evaluate.h"
#include "alidade/identifiability/analysis.h"
#include "alidade/identifiability/rules.h"
#include "alidade/io/files.h"
#include "alidade/report/format.h"
#include "alidade/solve/solver.h"
#include "study.h"

namespace alidade {
namespace {

double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

SolverRun Solve(SolverName name, const CalibrationProblem& problem,
                const SolverOptions& options) {
  SolverRun run;
  run.values = problem.model.NominalValues();
  run.summary = name == SolverName::kCeres
                    ? SolveCeres(problem, options, &run.values)
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

class JobRunner {
 public:
  JobRunner(const JobConfig& config, int num_threads)
      : config_(config), model_(config.arm, num_threads) {
    outcome_.calibrated = config.arm;
  }

  JobOutcome Run(const std::string& command) {
    DescribeInputs(command);
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
    result().runs.push_back(Solve(config_.solver, *problem_, options));
    const SolverSummary& summary = result().runs.front().summary;
    if (!summary.IsSolutionUsable()) {
      outcome_.status = JobStatus::kFailed;
      outcome_.message = "the solver " + summary.solver + " " +
                         ToString(summary.status) + ": " + summary.message;
      return false;
    }
    for (const SolverName other : config_.compare_with) {
      if (other == config_.solver) continue;
      result().runs.push_back(Solve(other, *problem_, options));
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
    const int freedom = summary.num_residuals - summary.num_free;
    const double ratio =
        std::sqrt(ChiSquare(result().train.residual_after, config_.data) /
                  std::max(1, freedom));
    if (freedom > 0 && ratio > kLargeResiduals) {
      Warn("the residuals are " + FormatSignificant(ratio, 3) +
           " times as large as the sigmas say: look for wrong units, columns, "
           "outliers, sigmas or a wrong arm");
    }
    DoubtPriors(deviations);
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
  const JobConfig& config_;
  PositionModel model_;
  std::optional<CalibrationProblem> problem_;
  JobOutcome outcome_;
};

}  // namespace

JobOutcome RunJob(const JobConfig& config, const std::string& command,
                  int num_threads) {
  return JobRunner(config, num_threads).Run(command);
}

IdentifiabilityResult IdentifyJob(const JobConfig& config, int num_threads) {
  const PositionModel model(config.arm, num_threads);
  return AnalyzeIdentifiability(model, config.data, config.identifiability);
}

}  // namespace alidade
