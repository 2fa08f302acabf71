#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "alidade/measurement/position_cost.h"
#include "alidade/solve/solver.h"
#include "progress.h"

namespace alidade {
namespace {

// Levenberg-Marquardt adds 1 / sqrt(radius) to the singular values of a
// Jacobian with unit columns. A thirtieth of the smallest one that counts
// leaves the first steps those of Gauss-Newton in all directions that the rank
// counts, and damps those it does not, along which a step would be long and
// wild.
double ChooseTrustRegionRadius(const RankReport& start_rank) {
  constexpr double kCeresDefault = 1e4;
  const double damping = start_rank.SmallestCounted() / 30.0;
  return std::max(kCeresDefault, 1.0 / (damping * damping));
}

// Free columns of one block, as indices within it.
std::vector<int> FreeInBlock(const CalibrationProblem& problem,
                             const ParameterBlock& block) {
  std::vector<int> free;
  for (const int column : problem.free_columns) {
    const int index = column - block.first_column;
    if (index >= 0 && index < block.size) free.push_back(index);
  }
  return free;
}

std::vector<int> Complement(const std::vector<int>& free, int size) {
  std::vector<int> held;
  for (int i = 0; i < size; ++i) {
    if (!std::binary_search(free.begin(), free.end(), i)) held.push_back(i);
  }
  return held;
}

// Base and tool are blocks of the problem only where something in them is free.
bool NeedsFrames(const CalibrationProblem& problem) {
  const ParameterLayout& layout = problem.model.layout();
  return std::any_of(
      problem.free_columns.begin(), problem.free_columns.end(),
      [&](int column) {
        return !ParameterLayout::IsJointKind(layout.parameter(column).kind);
      });
}

void HoldFrozenParameters(const CalibrationProblem& problem, double* values,
                          ceres::Problem* ceres_problem) {
  for (const ParameterBlock& block : problem.model.layout().blocks()) {
    double* const data = values + block.first_column;
    if (!ceres_problem->HasParameterBlock(data)) continue;
    const std::vector<int> free = FreeInBlock(problem, block);
    if (free.empty()) {
      ceres_problem->SetParameterBlockConstant(data);
    } else if (static_cast<int>(free.size()) < block.size) {
      ceres_problem->SetManifold(
          data,
          new ceres::SubsetManifold(block.size, Complement(free, block.size)));
    }
  }
}

// Ours, handed to Ceres, so that the loss has one definition.
class CeresLoss : public ceres::LossFunction {
 public:
  explicit CeresLoss(const RobustLoss& loss) : loss_(loss) {}
  void Evaluate(double s, double* rho) const override {
    loss_.Evaluate(s, rho);
  }

 private:
  RobustLoss loss_;
};

void AddResiduals(const CalibrationProblem& problem, double* values,
                  ceres::Problem* ceres_problem) {
  const bool with_frames = NeedsFrames(problem);
  const ParameterLayout& layout = problem.model.layout();
  std::vector<double*> blocks;
  for (const ParameterBlock& block : layout.blocks()) {
    const ParameterKind kind = layout.parameter(block.first_column).kind;
    if (with_frames || ParameterLayout::IsJointKind(kind)) {
      blocks.push_back(values + block.first_column);
    }
  }
  const bool is_robust = problem.loss.kind != LossKind::kNone;
  // Shared by all residual blocks; the problem owns it.
  ceres::LossFunction* const loss =
      is_robust ? new CeresLoss(problem.loss) : nullptr;
  const Dataset& data = problem.data;
  for (Eigen::Index i = 0; i < data.num_poses(); ++i) {
    const PositionObservation observation{data.joint_values.col(i).data(),
                                          data.positions.col(i),
                                          data.sigmas.col(i)};
    ceres_problem->AddResidualBlock(
        MakePositionCost(problem.model.nominal(), observation, with_frames)
            .release(),
        loss, blocks);
  }
}

// (value - nominal) / prior for some entries of one parameter block.
class PriorResidual : public ceres::CostFunction {
 public:
  struct Entry {
    int index;  // in the block
    double nominal;
    double prior;
  };

  PriorResidual(int block_size, std::vector<Entry> entries)
      : entries_(std::move(entries)) {
    mutable_parameter_block_sizes()->push_back(block_size);
    set_num_residuals(static_cast<int>(entries_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const int size = parameter_block_sizes()[0];
    const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    if (wants_jacobian) {
      std::fill_n(jacobians[0], num_residuals() * size, 0.0);
    }
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const Entry& entry = entries_[k];
      residuals[k] = (parameters[0][entry.index] - entry.nominal) / entry.prior;
      if (wants_jacobian) {
        jacobians[0][k * size + entry.index] = 1.0 / entry.prior;
      }
    }
    return true;
  }

 private:
  std::vector<Entry> entries_;
};

void AddPriors(const CalibrationProblem& problem, double* values,
               ceres::Problem* ceres_problem) {
  const std::vector<int> with_prior = problem.ColumnsWithPrior();
  const Eigen::VectorXd nominal = problem.model.NominalValues();
  for (const ParameterBlock& block : problem.model.layout().blocks()) {
    std::vector<PriorResidual::Entry> entries;
    for (const int column : with_prior) {
      const int index = column - block.first_column;
      if (index < 0 || index >= block.size) continue;
      entries.push_back({index, nominal[column], problem.priors[column]});
    }
    if (entries.empty()) continue;
    ceres_problem->AddResidualBlock(
        new PriorResidual(block.size, std::move(entries)), nullptr,
        values + block.first_column);
  }
}

// What the linear model expected chi-square to lose, from what it lost and the
// ratio of the two.
double PredictedDecrease(const ceres::IterationSummary& iteration) {
  // An invalid step, with which Ceres deals by a smaller trust region, says
  // nothing: count it as large.
  if (!iteration.step_is_valid) return 2.0 * iteration.cost;
  // Nothing changed to the last bit: no step can be smaller.
  if (iteration.relative_decrease == 0.0) return 0.0;
  return 2.0 * iteration.cost_change / iteration.relative_decrease;
}

// Hands every iteration of Ceres to the shared stopping rules. Ceres' cost is
// half of chi-square, and so is its predicted decrease.
class StoppingRules : public ceres::IterationCallback {
 public:
  StoppingRules(const Eigen::VectorXd& values, Progress* progress)
      : values_(values), progress_(progress) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0) return ceres::SOLVER_CONTINUE;
    IterationStep step;
    step.norm = iteration.step_norm;
    step.accepted = iteration.step_is_successful;
    step.predicted_decrease = PredictedDecrease(iteration);
    return progress_->Record(step, values_)
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Eigen::VectorXd& values_;
  Progress* progress_;
};

ceres::Solver::Options CeresOptions(const SolverOptions& options,
                                    double radius) {
  ceres::Solver::Options ceres_options;
  ceres_options.minimizer_type = ceres::TRUST_REGION;
  ceres_options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  ceres_options.linear_solver_type = ceres::DENSE_QR;
  ceres_options.num_threads = 1;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.update_state_every_iteration = true;
  ceres_options.initial_trust_region_radius = radius;
  ceres_options.max_trust_region_radius =
      std::max(radius, ceres_options.max_trust_region_radius);
  ceres_options.max_num_iterations = options.max_iterations;
  // The shared rules stop the solve; Ceres' own would stop it by others.
  ceres_options.function_tolerance = 0.0;
  ceres_options.gradient_tolerance = 0.0;
  ceres_options.parameter_tolerance = 0.0;
  return ceres_options;
}

// Where Ceres ended without the shared rules having a word.
void ExplainTermination(const ceres::Solver::Summary& ceres_summary,
                        Progress* progress) {
  if (progress->stopped()) return;
  if (ceres_summary.termination_type == ceres::CONVERGENCE) {
    progress->Stop(SolverStatus::kConverged, ceres_summary.message);
  } else {
    progress->Stop(SolverStatus::kFailed,
                   "Ceres: " + ceres_summary.message +
                       " Look for poses or units that are wrong, or fix what "
                       "the identifiability pass calls weak");
  }
}

}  // namespace

SolverSummary SolveCeres(const CalibrationProblem& problem,
                         const SolverOptions& options,
                         Eigen::VectorXd* values) {
  Progress progress(problem, options, "ceres");
  Eigen::VectorXd current = *values;
  if (progress.Start(current)) {
    ceres::Problem ceres_problem;
    AddResiduals(problem, current.data(), &ceres_problem);
    AddPriors(problem, current.data(), &ceres_problem);
    HoldFrozenParameters(problem, current.data(), &ceres_problem);
    const double given = options.initial_trust_region_radius;
    const double radius =
        given > 0.0 ? given : ChooseTrustRegionRadius(problem.start_rank);
    progress.summary().trust_region_used = radius;
    progress.summary().setup_time_s = progress.stopwatch().Seconds();
    ceres::Solver::Options ceres_options = CeresOptions(options, radius);
    StoppingRules stopping_rules(current, &progress);
    ceres_options.callbacks.push_back(&stopping_rules);
    ceres::Solver::Summary ceres_summary;
    ceres::Solve(ceres_options, &ceres_problem, &ceres_summary);
    ExplainTermination(ceres_summary, &progress);
  }
  progress.Finish();
  if (progress.summary().IsSolutionUsable()) *values = current;
  return progress.summary();
}

}  // namespace alidade
