#include "src/solve/progress.h"

#include <cmath>
#include <string>
#include <vector>

#include "src/kernel/reduction.h"

namespace alidade::internal {

std::vector<int> CalibrationProblem::ColumnsWithPrior() const {
  std::vector<int> columns;
  if (priors.size() == 0) return columns;
  for (const int column : free_columns) {
    if (std::isfinite(priors[column])) columns.push_back(column);
  }
  return columns;
}

double Stopwatch::Seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                       start_)
      .count();
}

Progress::Progress(const CalibrationProblem& problem,
                   const SolverOptions& options, const std::string& solver)
    : problem_(problem),
      options_(options),
      sigmas_(SumSigmas(problem.data, problem.model.execution())) {
  summary_.solver = solver;
  summary_.num_poses = static_cast<int>(problem.data.global_poses());
  summary_.num_residuals = static_cast<int>(sigmas_.equations);
  summary_.num_parameters = problem.model.layout().size();
  summary_.num_free = static_cast<int>(problem.free_columns.size());
  summary_.threads_given = options.num_threads;
  summary_.trust_region_given = options.initial_trust_region_radius;
  summary_.pseudo_inverse_tolerance_given = options.pseudo_inverse_tolerance;
  summary_.precision_limit = problem.model.RoundingError();
}

// What the rounding of every row adds up to as a chi-square. An angle's
// rounding is that of a length, seen from the end of the reach.
double Progress::FloorCost() const {
  const double floor =
      options_.precision_limit_factor * summary_.precision_limit;
  const double angle = floor / Reach(problem_.model.nominal());
  return floor * floor * sigmas_.length_information +
         angle * angle * sigmas_.rotation_information;
}

// A column whose value is not within its bounds, or -1.
int Progress::OutOfBounds(const Eigen::VectorXd& values) const {
  if (problem_.lower.size() == 0) return -1;
  for (int column = 0; column < static_cast<int>(values.size()); ++column) {
    if (values[column] < problem_.lower[column] ||
        values[column] > problem_.upper[column]) {
      return column;
    }
  }
  return -1;
}

bool Progress::CheckProblem(const Eigen::VectorXd& values) {
  std::string error;
  if (!options_.IsValid(&error)) {
    Stop(SolverStatus::kUnusable, "invalid option: " + error);
  } else if (values.size() != problem_.model.layout().size()) {
    Stop(SolverStatus::kUnusable,
         "the starting point has " + std::to_string(values.size()) +
             " values, the model " +
             std::to_string(problem_.model.layout().size()));
  } else if (problem_.data.num_joints() !=
             problem_.model.layout().num_joints()) {
    Stop(SolverStatus::kUnusable,
         "the data set has " + std::to_string(problem_.data.num_joints()) +
             " joints, the arm " +
             std::to_string(problem_.model.layout().num_joints()));
  } else if (summary_.num_free == 0) {
    Stop(SolverStatus::kUnusable, "no parameter is free");
  } else if (const int column = OutOfBounds(values); column >= 0) {
    Stop(SolverStatus::kUnusable,
         "the starting point of " +
             problem_.model.layout().parameter(column).name +
             " is not within its bounds, which are of its value and not of its "
             "deviation");
  } else if (problem_.priors.size() != 0 &&
             problem_.priors.size() != values.size()) {
    Stop(SolverStatus::kUnusable, "priors must be empty or one per parameter");
  } else if (summary_.num_residuals +
                 static_cast<int>(problem_.ColumnsWithPrior().size()) <
             summary_.num_free) {
    Stop(SolverStatus::kUnusable,
         std::to_string(summary_.num_poses) + " poses give " +
             std::to_string(summary_.num_residuals) + " equations for " +
             std::to_string(summary_.num_free) +
             " parameters: measure more poses or fix parameters");
  } else if (!sigmas_.are_positive) {
    Stop(SolverStatus::kUnusable, "a sigma is not positive");
  }
  return !stopped();
}

bool Progress::Start(const Eigen::VectorXd& values,
                     ReducedLeastSquares* reduced) {
  if (!CheckProblem(values)) return false;
  floor_cost_ = FloorCost();
  ReducerOptions reducer_options;
  reducer_options.priors = problem_.priors;
  reducer_.emplace(problem_.model, problem_.data, problem_.free_columns,
                   problem_.losses, reducer_options);
  if (reduced != nullptr) reducer_->Reduce(values, reduced);
  const IterationRecord record = Evaluate(values);
  summary_.initial_cost = record.cost;
  Tell(record);
  if (!std::isfinite(record.cost)) {
    Stop(SolverStatus::kUnusable,
         "the residuals at the starting point are not finite: look for NaN or "
         "huge values in the data or the arm");
  }
  return !stopped();
}

IterationRecord Progress::Evaluate(const Eigen::VectorXd& values) {
  IterationRecord record;
  const ResidualSummary& residuals = reducer_->Summarize(values);
  record.cost = residuals.cost;
  record.max_error = residuals.max_error;
  record.rms_error = residuals.rms_error;
  record.time_s = stopwatch_.Seconds();
  record.values = values;
  return record;
}

bool Progress::ReachedPrecision(const IterationRecord& record) {
  if (!(record.max_error <= options_.wanted_precision)) return false;
  Stop(SolverStatus::kConverged, "the wanted precision is reached");
  return true;
}

namespace {

// A cost of so many numerical precision limits is still that of data without
// noise: the last step may leave a little more than the floor.
constexpr double kExactData = 100.0;

}  // namespace

bool Progress::IsBelowFloor(double predicted_decrease) const {
  return options_.precision_limit_factor > 0.0 &&
         predicted_decrease <= floor_cost_;
}

bool Progress::IsBelowTolerance(double predicted_decrease, double cost) const {
  return options_.function_tolerance > 0.0 &&
         predicted_decrease <= options_.function_tolerance * cost;
}

bool Progress::WouldStop(double predicted_decrease) const {
  return IsBelowFloor(predicted_decrease) ||
         IsBelowTolerance(predicted_decrease, cost());
}

bool Progress::Record(const IterationStep& step,
                      const Eigen::VectorXd& values) {
  const double cost_before = cost();
  IterationRecord record = Evaluate(values);
  record.iteration = static_cast<int>(summary_.iterations.size());
  record.step_norm = step.norm;
  record.accepted = step.accepted;
  Tell(record);
  ++(step.accepted ? summary_.accepted_steps : summary_.rejected_steps);
  if (!std::isfinite(record.cost)) {
    Stop(SolverStatus::kFailed,
         "the iteration diverged to values that are not finite: fix what the "
         "identifiability pass calls weak, or use another solver");
  } else if (step.accepted && options_.wanted_precision > 0.0 &&
             ReachedPrecision(record)) {
    return true;
  } else if (IsBelowFloor(step.predicted_decrease)) {
    // With noise in the data the cost is far above the floor: a minimum, found
    // as exactly as rounding allows.
    const bool exact_data = record.cost <= kExactData * floor_cost_;
    Stop(exact_data ? SolverStatus::kPrecisionLimit : SolverStatus::kConverged,
         "the last step changed the residuals by less than their rounding "
         "errors");
  } else if (IsBelowTolerance(step.predicted_decrease, cost_before)) {
    Stop(SolverStatus::kConverged,
         "the last step lowered the cost by less than function_tolerance");
  } else if (!step.accepted &&
             step.predicted_decrease <=
                 2.0 * std::sqrt(record.cost) * std::sqrt(floor_cost_)) {
    // Rounding of the residuals, times twice their norm, is rounding of the
    // cost: whether such a step is accepted is chance.
    Stop(SolverStatus::kConverged,
         "the cost cannot distinguish steps this small from its rounding "
         "errors");
  } else if (record.iteration >= options_.max_iterations) {
    Stop(SolverStatus::kIterationLimit,
         "max_iterations = " + std::to_string(options_.max_iterations) +
             " is used up");
  }
  return stopped();
}

void Progress::Tell(const IterationRecord& record) {
  summary_.iterations.push_back(record);
  if (options_.on_iteration) options_.on_iteration(record);
}

void Progress::Stop(SolverStatus status, const std::string& message) {
  summary_.status = status;
  summary_.message = message;
}

void Progress::Finish() {
  summary_.threads_used = problem_.model.num_threads();
  if (!summary_.iterations.empty()) {
    summary_.final_cost = summary_.iterations.back().cost;
  }
  summary_.solve_time_s = stopwatch_.Seconds() - summary_.setup_time_s;
}

void PrependIterations(const SolverSummary& earlier, SolverSummary* summary) {
  std::vector<IterationRecord> all = earlier.iterations;
  const double time = all.empty() ? 0.0 : all.back().time_s;
  for (IterationRecord record : summary->iterations) {
    // It begins where the earlier one ended, which is no further iteration.
    if (record.iteration == 0 && !all.empty()) continue;
    record.iteration = static_cast<int>(all.size());
    record.time_s += time;
    all.push_back(record);
  }
  summary->iterations = std::move(all);
  summary->accepted_steps += earlier.accepted_steps;
  summary->rejected_steps += earlier.rejected_steps;
  summary->setup_time_s += earlier.setup_time_s;
  summary->solve_time_s += earlier.solve_time_s;
}

}  // namespace alidade::internal
