#include "src/simulation/noise_study.h"

#include <cmath>
#include <string>
#include <vector>

#include "src/common/parallel.h"
#include "src/common/random.h"
#include "src/identifiability/analysis.h"
#include "src/identifiability/rules.h"
#include "src/model/joint_draw.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

double RootMeanSquare(const Eigen::Matrix3Xd& errors) {
  return std::sqrt(errors.colwise().squaredNorm().mean());
}

// A method, ready to be run on any noise: the analysis depends on the poses
// and the sigmas alone.
struct Method {
  std::string name;
  SolverName solver;
  std::vector<int> free_columns;
  RankReport start_rank;
  Eigen::VectorXd priors;
};

class NoiseStudy {
 public:
  NoiseStudy(const CalibrationTask& task, const NoiseStudyConfig& study)
      : task_(task),
        study_(study),
        model_(task.arm),
        exact_(task.data.training),
        workspace_(
            DrawJointValues(task.arm, study_.workspace_poses, study_.seed + 1)),
        true_workspace_(model_.Predict(*task.options.true_values, workspace_)) {
    exact_.positions() =
        model_.Predict(*task.options.true_values, exact_.joint_values);
  }

  NoiseStudyResult Run() {
    const std::vector<Method> methods = {
        Prepare("published: rules, pseudo-inverse",
                IdentifiabilityMethod::kRules, WeakPolicy::kKeep),
        Prepare("default: rank, priors", IdentifiabilityMethod::kRank,
                WeakPolicy::kPrior),
        Prepare("rank, weak ones fixed", IdentifiabilityMethod::kRank,
                WeakPolicy::kFreeze)};
    NoiseStudyResult result;
    result.trials = study_.trials;
    result.workspace_poses = study_.workspace_poses;
    result.sigma = exact_.sigmas()(0, 0);
    result.seed = study_.seed;
    const Eigen::VectorXd nominal = model_.NominalValues();
    result.data_rms_before = DataRms(nominal);
    result.workspace_rms_before = WorkspaceRms(nominal);
    for (const Method& method : methods) {
      result.methods.push_back(RunTrials(method));
    }
    return result;
  }

 private:
  Method Prepare(const std::string& name, IdentifiabilityMethod method,
                 WeakPolicy policy) const {
    IdentifiabilityOptions options = task_.options.identifiability;
    options.method = method;
    options.policy = policy;
    const IdentifiabilityResult pass =
        AnalyzeIdentifiability(model_, exact_, options);
    const SolverName solver = method == IdentifiabilityMethod::kRules
                                  ? SolverName::kPseudoInverse
                                  : SolverName::kCeres;
    return {name, solver, FreeColumns(pass), pass.nominal_rank, PriorsOf(pass)};
  }

  NoiseStudyMethod RunTrials(const Method& method) const {
    NoiseStudyMethod out;
    out.name = method.name;
    out.data_rms.resize(study_.trials);
    out.workspace_rms.resize(study_.trials);
    std::vector<char> failed(study_.trials, 0);
    ParallelFor(task_.options.num_threads, study_.trials, 1,
                [&](std::int64_t begin, std::int64_t end) {
                  for (std::int64_t trial = begin; trial < end; ++trial) {
                    Eigen::VectorXd values = model_.NominalValues();
                    failed[trial] = Solve(method, trial, &values) ? 0 : 1;
                    out.data_rms[trial] = DataRms(values);
                    out.workspace_rms[trial] = WorkspaceRms(values);
                  }
                });
    for (const char flag : failed) out.failed += flag;
    return out;
  }

  bool Solve(const Method& method, std::int64_t trial,
             Eigen::VectorXd* values) const {
    Dataset noisy = exact_;
    Random random(study_.seed, static_cast<std::uint64_t>(trial));
    MatrixBuilder positions(exact_.positions());
    for (Eigen::Index i = 0; i < noisy.num_poses(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        positions.map()(axis, i) += noisy.sigmas()(axis, i) * random.Normal();
      }
    }
    noisy.positions() = positions.Freeze();
    const CalibrationProblem problem{model_, noisy, method.free_columns,
                                     method.start_rank, method.priors};
    SolverOptions options = task_.options.solver_options;
    options.num_threads = 1;
    options.on_iteration = {};  // not for many threads at once
    const SolverSummary summary =
        method.solver == SolverName::kCeres
            ? SolveLevenbergMarquardt(problem, options, values)
            : SolvePseudoInverse(problem, options, values);
    return summary.IsSolutionUsable();
  }

  double DataRms(const Eigen::VectorXd& values) const {
    return RootMeanSquare(model_.Predict(values, exact_.joint_values) -
                          exact_.positions().map());
  }

  double WorkspaceRms(const Eigen::VectorXd& values) const {
    return RootMeanSquare(model_.Predict(values, workspace_) - true_workspace_);
  }

  const CalibrationTask& task_;
  const NoiseStudyConfig& study_;
  const MeasurementModel model_;
  Dataset exact_;  // with the true positions
  const Eigen::MatrixXd workspace_;
  const Eigen::Matrix3Xd true_workspace_;
};

}  // namespace

NoiseStudyResult RunNoiseStudy(const CalibrationTask& task,
                               const NoiseStudyConfig& config) {
  return NoiseStudy(task, config).Run();
}

}  // namespace alidade::internal
