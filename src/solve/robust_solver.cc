#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "alidade/robust_loss.h"
#include "src/kernel/partition.h"
#include "src/solve/progress.h"
#include "src/solve/solve.h"

namespace alidade::internal {
namespace {

// What leads to a loss: each of these is a good enough start for the next.
std::vector<LossKind> StagesTo(LossKind loss) {
  switch (loss) {
    case LossKind::kNone:
      return {LossKind::kNone};
    case LossKind::kHuber:
      return {LossKind::kNone, LossKind::kHuber};
    case LossKind::kCauchy:
      return {LossKind::kHuber, LossKind::kCauchy};
    case LossKind::kTukey:
      return {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey};
  }
  return {};
}

// The equations that still have a say, each observation counted by its weight.
double EffectiveEquations(const CalibrationProblem& problem,
                          const Eigen::VectorXd& values) {
  const SharedVector squared =
      SquaredNorms(problem.model.Errors(values, problem.data), problem.data);
  const Eigen::VectorXi dimensions = Dimensions(problem.data);
  VectorBuilder all(squared.size());
  VectorBuilder::Map equations = all.map();
  equations.setZero();
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    const int dimension = dimensions[i];
    if (dimension == 0) continue;
    equations[i] = dimension;
    if (problem.losses.empty()) continue;
    equations[i] *= problem.losses[dimension - 1].Weight(squared[i]);
  }
  return SumInOrder(problem.model.communicator(), problem.data, all.Freeze());
}

// Data of which no more than this part is left are given up.
constexpr double kFewestLeft = 0.2;

void CheckWeights(const CalibrationProblem& problem,
                  const Eigen::VectorXd& values, SolverSummary* summary) {
  if (!summary->IsSolutionUsable() || problem.losses.empty()) return;
  const double equations = EffectiveEquations(problem, values);
  const auto free = static_cast<double>(problem.free_columns.size());
  const auto with_prior =
      static_cast<double>(problem.ColumnsWithPrior().size());
  const double needed =
      std::max(free - with_prior,
               kFewestLeft * static_cast<double>(GlobalEquations(
                                 problem.model.communicator(), problem.data)));
  if (equations >= needed) return;
  summary->status = SolverStatus::kFailed;
  summary->message =
      "the robust loss gives up nearly all observations (what is left weighs "
      "as " +
      std::to_string(static_cast<int>(equations)) + " equations for " +
      std::to_string(problem.free_columns.size()) +
      " parameters): the sigmas are too small, or the arm or the data are not "
      "what they are taken for";
}

}  // namespace

SolverSummary SolveRobust(const CalibrationProblem& problem, LossKind loss,
                          const SolverOptions& options, Eigen::VectorXd* values,
                          const Eigen::VectorXd& start) {
  const bool is_near = start.size() > 0 && loss != LossKind::kNone;
  Eigen::VectorXd current = is_near ? start : *values;
  SolverSummary summary;
  CalibrationProblem stage = problem;
  for (const LossKind kind :
       is_near ? std::vector<LossKind>{loss} : StagesTo(loss)) {
    stage.losses = TunedLosses(kind);
    SolverSummary next = SolveLevenbergMarquardt(stage, options, &current);
    PrependIterations(summary, &next);
    summary = std::move(next);
    if (!summary.IsSolutionUsable()) return summary;
  }
  CheckWeights(stage, current, &summary);
  if (summary.IsSolutionUsable()) *values = current;
  return summary;
}

}  // namespace alidade::internal
