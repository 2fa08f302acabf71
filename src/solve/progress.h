#ifndef ALIDADE_SRC_SOLVE_PROGRESS_H_
#define ALIDADE_SRC_SOLVE_PROGRESS_H_

#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <string>

#include "alidade/solver.h"
#include "src/kernel/reduction.h"
#include "src/kernel/sigma_totals.h"
#include "src/solve/solve.h"

namespace alidade::internal {

/// Wall time since construction.
class Stopwatch {
 public:
  double Seconds() const;

 private:
  std::chrono::steady_clock::time_point start_ =
      std::chrono::steady_clock::now();
};

/// What one iteration did, as every solver reports it.
struct IterationStep {
  double norm = 0.0;  ///< of the step in the parameters
  bool accepted = true;
  /// Chi-square the linear model expected to lose by the step.
  double predicted_decrease = 0.0;
};

/// The part that all solvers share: checks the problem, fills the Summary,
/// keeps the iteration records and decides when to stop, so that two solvers
/// stop by the same rules.
class Progress {
 public:
  Progress(const CalibrationProblem& problem, const SolverOptions& options,
           const std::string& solver);

  /// Of the problem's data and priors, over its free columns. @pre Start
  /// returned true.
  Reducer* reducer() { return &*reducer_; }

  /// Evaluates the starting point and records it as iteration 0. False where
  /// there is nothing to solve or it cannot be solved: the status says so.
  /// `reduced`: filled besides, in the same pass over the data.
  bool Start(const Eigen::VectorXd& values,
             ReducedLeastSquares* reduced = nullptr);

  /// The cost of the last record, priors included.
  double cost() const { return summary_.iterations.back().cost; }
  /// Whether a step that is predicted to lower the cost by so much ends the
  /// solve, whatever it does.
  bool WouldStop(double predicted_decrease) const;

  /// Records an iteration whose outcome is `values`. True: stop; status and
  /// message are set.
  bool Record(const IterationStep& step, const Eigen::VectorXd& values);

  void Stop(SolverStatus status, const std::string& message);
  bool stopped() const { return summary_.status != SolverStatus::kNotRun; }

  /// Sets times and the final cost.
  void Finish();

  SolverSummary& summary() { return summary_; }
  const Stopwatch& stopwatch() const { return stopwatch_; }

 private:
  double FloorCost() const;
  bool IsBelowFloor(double predicted_decrease) const;
  bool IsBelowTolerance(double predicted_decrease, double cost) const;
  int OutOfBounds(const Eigen::VectorXd& values) const;
  bool CheckProblem(const Eigen::VectorXd& values);
  IterationRecord Evaluate(const Eigen::VectorXd& values);
  void Tell(const IterationRecord& record);
  bool ReachedPrecision(const IterationRecord& record);

  const CalibrationProblem& problem_;
  const SolverOptions& options_;
  SolverSummary summary_;
  Stopwatch stopwatch_;
  const SigmaTotals sigmas_;
  double floor_cost_ = 0.0;
  std::optional<Reducer> reducer_;
};

/// The iterations of `earlier`, with their steps and times, come before those
/// of `summary`, whose entry 0 is left out: it is no iteration but the state
/// that the earlier solve led to.
void PrependIterations(const SolverSummary& earlier, SolverSummary* summary);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_SOLVE_PROGRESS_H_
