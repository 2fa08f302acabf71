#include "src/solve/bounded_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/kernel/reduction.h"
#include "src/solve/progress.h"

namespace alidade::internal {
namespace {

constexpr int kNone = -1;

class BoundedSolver {
 public:
  BoundedSolver(const CalibrationProblem& problem, const SolverOptions& options,
                const UnboundedSolver& solve, Eigen::VectorXd start)
      : problem_(problem),
        options_(options),
        solve_(solve),
        values_(std::move(start)),
        is_held_(values_.size(), false) {}

  SolverSummary Run() {
    // Every bound is met and left some times at most, or they go in circles.
    const auto most = static_cast<int>(4 * problem_.free_columns.size() + 4);
    for (int round = 0; round < most; ++round) {
      Eigen::VectorXd trial = values_;
      if (!SolveFree(&trial)) return std::move(summary_);
      if (GoTowards(trial)) continue;
      const int released = WorstHeld();
      if (released == kNone) return Finish();
      is_held_[released] = false;
    }
    summary_.status = SolverStatus::kIterationLimit;
    summary_.message = "bounds are met and left again and again: widen them";
    return Finish();
  }

  const Eigen::VectorXd& values() const { return values_; }

 private:
  // The last solve may have ended elsewhere: beyond the bound that was met.
  SolverSummary Finish() {
    Reducer reducer = MakeReducer();
    summary_.final_cost = reducer.Summarize(values_).cost;
    return std::move(summary_);
  }

  Reducer MakeReducer() const {
    ReducerOptions options;
    options.priors = problem_.priors;
    return Reducer(problem_.model, problem_.data, problem_.free_columns,
                   problem_.losses, options);
  }

  // Over the free columns that no bound holds. False where that is not usable.
  bool SolveFree(Eigen::VectorXd* trial) {
    CalibrationProblem part = problem_;
    part.lower.resize(0);
    part.upper.resize(0);
    part.free_columns.clear();
    for (const int column : problem_.free_columns) {
      if (!is_held_[column]) part.free_columns.push_back(column);
    }
    if (part.free_columns.empty()) return true;
    SolverOptions options = options_;
    options.max_iterations =
        std::max(1, options.max_iterations -
                        static_cast<int>(summary_.iterations.size()));
    Append(solve_(part, options, trial));
    return summary_.IsSolutionUsable();
  }

  void Append(SolverSummary more) {
    more.num_free = static_cast<int>(problem_.free_columns.size());
    if (!summary_.iterations.empty()) {
      PrependIterations(summary_, &more);
      more.initial_cost = summary_.initial_cost;
    }
    summary_ = std::move(more);
  }

  // As far as the first bound lets; that one then holds. False: to the end.
  bool GoTowards(const Eigen::VectorXd& trial) {
    double part = 1.0;
    int first = kNone;
    for (const int column : problem_.free_columns) {
      const double bound = Passed(column, trial[column]);
      if (bound == trial[column]) continue;
      const double here =
          (bound - values_[column]) / (trial[column] - values_[column]);
      if (first != kNone && here >= part) continue;
      part = here;
      first = column;
    }
    if (first == kNone) {
      values_ = trial;
      return false;
    }
    const double bound = Passed(first, trial[first]);
    values_ += part * (trial - values_);
    values_[first] = bound;
    is_held_[first] = true;
    return true;
  }

  // The bound that a value is beyond, or the value.
  double Passed(int column, double value) const {
    return std::clamp(value, problem_.lower[column], problem_.upper[column]);
  }

  // The parameter at a bound that the cost would fall by most without.
  int WorstHeld() const {
    if (std::find(is_held_.begin(), is_held_.end(), true) == is_held_.end()) {
      return kNone;
    }
    Reducer reducer = MakeReducer();
    ReducedLeastSquares reduced;
    reducer.Reduce(values_, &reduced);
    const Eigen::VectorXd gradient =
        reduced.factor.transpose() * reduced.projected;
    const Eigen::VectorXd norms = reduced.factor.colwise().norm();
    // What rounding and the last step leave of a gradient that is zero.
    double worst = 1e-8 * std::sqrt(reduced.cost);
    int released = kNone;
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      const int column = problem_.free_columns[k];
      if (!is_held_[column] || !(norms[k] > 0.0)) continue;
      const bool is_lower = values_[column] == problem_.lower[column];
      const double inwards = (is_lower ? -gradient[k] : gradient[k]) / norms[k];
      if (inwards <= worst) continue;
      worst = inwards;
      released = column;
    }
    return released;
  }

  const CalibrationProblem& problem_;
  const SolverOptions& options_;
  const UnboundedSolver& solve_;
  Eigen::VectorXd values_;
  std::vector<bool> is_held_;  // by column
  SolverSummary summary_;
};

}  // namespace

SolverSummary SolveWithinBounds(const CalibrationProblem& problem,
                                const SolverOptions& options,
                                const UnboundedSolver& solve,
                                Eigen::VectorXd* values) {
  BoundedSolver solver(problem, options, solve, *values);
  SolverSummary summary = solver.Run();
  if (summary.IsSolutionUsable()) *values = solver.values();
  return summary;
}

}  // namespace alidade::internal
