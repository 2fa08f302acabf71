#ifndef ALIDADE_SRC_PLANNING_PLAN_EVALUATION_H_
#define ALIDADE_SRC_PLANNING_PLAN_EVALUATION_H_

#include <string>
#include <vector>

#include "alidade/plan.h"
#include "src/kernel/measurement_model.h"
#include "src/planning/exchange.h"
#include "src/planning/plan_problem.h"
#include "src/planning/plan_task.h"

namespace alidade::internal {

/// The problem with the candidates that a plan determines worst and its own:
/// other plans of about its size choose nearly all of their poses among these.
DesignProblem WorstTold(const PlanProblem& problem, const DesignResult& plan,
                        int num_threads);

/// What plans predict. Its arguments outlive it.
class PlanEvaluator {
 public:
  PlanEvaluator(const PlanTask& config, const MeasurementModel& model,
                const PlanProblem& problem)
      : config_(config), model_(model), problem_(problem) {}

  /// Largest predicted standard deviation over the region (m); infinite where
  /// the plan determines too little.
  double WorstOverRegion(const DesignResult& plan) const;

  /// Parameters; the plan beside the greedy one, random poses and none; bounds.
  void Evaluate(const DesignResult& plan, PlanResult* result) const;

  /// Plans of other sizes beside random poses.
  void DrawCurve(const DesignResult& plan, PlanResult* result) const;

 private:
  int threads() const { return model_.num_threads(); }
  double num_parameters() const {
    return problem_.design.candidates.num_parameters();
  }

  Eigen::MatrixXd KnownWith(const PoseRows& rows,
                            const std::vector<int>& chosen) const;
  ObservabilityIndices Observability(const PoseRows& rows,
                                     const std::vector<int>& chosen) const;
  PlanEvaluation EvaluatePoses(const std::string& name, const PoseRows& rows,
                               const std::vector<int>& chosen) const;
  std::vector<int> DrawPoses(int count, int draw) const;
  PlanEvaluation EvaluateRandom(int count, PlanResult* result) const;
  Eigen::VectorXd Deviations(const Eigen::MatrixXd& information) const;
  void ListParameters(const DesignResult& plan, PlanResult* result) const;
  void ListTerms(const Eigen::VectorXd& planned, int num_poses,
                 PlanResult* result) const;
  double BoundOf(int num_poses) const;
  std::vector<int> CurveNumbers(int num_poses) const;
  PredictedAccuracy RandomAccuracy(int count) const;

  const PlanTask& config_;
  const MeasurementModel& model_;
  const PlanProblem& problem_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_EVALUATION_H_
