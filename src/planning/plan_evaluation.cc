#include "src/planning/plan_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "src/common/constants.h"
#include "src/common/random.h"
#include "src/identifiability/observability.h"
#include "src/planning/criterion.h"
#include "src/planning/efficiency.h"

namespace alidade::internal {
namespace {

// Draws of random poses that a median is taken of.
constexpr int kRandomDraws = 20;
constexpr int kCurveDraws = 10;

// Plans of other sizes choose among so many candidates.
constexpr int kCurveCandidates = 1500;

// Streams of the seed for random poses, apart from those of the exchange.
constexpr std::uint64_t kDrawStreams = std::uint64_t{1} << 33U;

double Median(std::vector<double> values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool IsSingular(const Eigen::MatrixXd& information) {
  return std::isinf(CriterionValue(DesignCriterion::kD, information, {}));
}

PredictedAccuracy Predict(const PoseRows& positions,
                          const Eigen::MatrixXd& information, int num_threads) {
  if (IsSingular(information)) return {};
  const Eigen::VectorXd variances =
      PredictedVariances(positions, information, num_threads);
  if (!variances.allFinite()) return {};
  return {std::sqrt(variances.maxCoeff()), std::sqrt(variances.mean())};
}

// Of each number of several draws.
PlanEvaluation MedianOf(const std::vector<PlanEvaluation>& draws) {
  const auto median = [&](auto part, auto member) {
    std::vector<double> values;
    for (const PlanEvaluation& draw : draws) {
      values.push_back(draw.*part.*member);
    }
    return Median(std::move(values));
  };
  PlanEvaluation medians;
  for (const auto part :
       {&PlanEvaluation::candidates, &PlanEvaluation::region}) {
    medians.*part = {median(part, &PredictedAccuracy::worst),
                     median(part, &PredictedAccuracy::rms)};
  }
  for (const auto member :
       {&ObservabilityIndices::o1, &ObservabilityIndices::o2,
        &ObservabilityIndices::o3, &ObservabilityIndices::o4,
        &ObservabilityIndices::o5, &ObservabilityIndices::condition}) {
    medians.observability.*member =
        median(&PlanEvaluation::observability, member);
  }
  return medians;
}

}  // namespace

DesignProblem WorstTold(const PlanProblem& problem, const DesignResult& plan,
                        int num_threads) {
  const PoseRows& candidates = problem.design.candidates;
  const Eigen::VectorXd variances =
      PredictedVariances(candidates, plan.information, num_threads);
  std::vector<int> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return variances[a] > variances[b]; });
  order.resize(std::min<std::size_t>(order.size(), kCurveCandidates));
  order.insert(order.end(), plan.chosen.begin(), plan.chosen.end());
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  return RestrictCandidates(problem.design, order);
}

double PlanEvaluator::WorstOverRegion(const DesignResult& plan) const {
  if (plan.chosen.empty()) return kInfinity;
  return Predict(problem_.region, plan.information, threads()).worst;
}

Eigen::MatrixXd PlanEvaluator::KnownWith(const PoseRows& rows,
                                         const std::vector<int>& chosen) const {
  return problem_.design.known + InformationOf(rows, chosen);
}

ObservabilityIndices PlanEvaluator::Observability(
    const PoseRows& rows, const std::vector<int>& chosen) const {
  const Eigen::Index p = rows.num_parameters();
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd stacked =
      Eigen::MatrixXd::Zero(std::max(count * rows.rows_each, p), p);
  for (Eigen::Index i = 0; i < count; ++i) {
    stacked.middleRows(i * rows.rows_each, rows.rows_each) =
        rows.Pose(chosen[i]).transpose() * config_.measurement.sigma;
  }
  return ComputeObservability(stacked, count);
}

PlanEvaluation PlanEvaluator::EvaluatePoses(
    const std::string& name, const PoseRows& rows,
    const std::vector<int>& chosen) const {
  PlanEvaluation evaluation;
  evaluation.name = name;
  const Eigen::MatrixXd information = KnownWith(rows, chosen);
  evaluation.candidates =
      Predict(problem_.candidate_positions, information, threads());
  evaluation.region = Predict(problem_.region, information, threads());
  if (!chosen.empty()) evaluation.observability = Observability(rows, chosen);
  return evaluation;
}

// Without repeats while there are enough (Fisher and Yates).
std::vector<int> PlanEvaluator::DrawPoses(int count, int draw) const {
  Random random(config_.seed, kDrawStreams + static_cast<std::uint64_t>(draw));
  std::vector<int> all(problem_.random.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> drawn;
  for (int i = 0; i < count; ++i) {
    const auto size = static_cast<int>(all.size());
    const int first = i % size;
    const int other =
        first + static_cast<int>(random.Uniform() * (size - first));
    std::swap(all[first], all[other]);
    drawn.push_back(all[first]);
  }
  return drawn;
}

PlanEvaluation PlanEvaluator::EvaluateRandom(int count,
                                             PlanResult* result) const {
  std::vector<PlanEvaluation> draws;
  std::vector<std::vector<double>> deviations(problem_.columns.size());
  for (int draw = 0; draw < kRandomDraws; ++draw) {
    const std::vector<int> poses = DrawPoses(count, draw);
    draws.push_back(EvaluatePoses("", problem_.random, poses));
    const Eigen::VectorXd of_draw =
        Deviations(KnownWith(problem_.random, poses));
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      deviations[i].push_back(of_draw[i]);
    }
  }
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    result->parameters[i].random_std = Median(std::move(deviations[i]));
  }
  PlanEvaluation random = MedianOf(draws);
  random.name = "random (median of " + std::to_string(kRandomDraws) + ")";
  return random;
}

// The rows of an identity predict the parameters themselves.
Eigen::VectorXd PlanEvaluator::Deviations(
    const Eigen::MatrixXd& information) const {
  const Eigen::Index p = information.rows();
  if (IsSingular(information)) return Eigen::VectorXd::Constant(p, kInfinity);
  PoseRows unit;
  unit.rows_each = 1;
  unit.transposed.setIdentity(p, p);
  return PredictedVariances(unit, information, 1)
      .cwiseSqrt()
      .cwiseQuotient(problem_.scales);
}

void PlanEvaluator::ListParameters(const DesignResult& plan,
                                   PlanResult* result) const {
  const Eigen::VectorXd planned = Deviations(plan.information);
  for (std::size_t i = 0; i < problem_.columns.size(); ++i) {
    const int column = problem_.columns[i];
    const Parameter& parameter = model_.layout().parameter(column);
    PlannedParameter entry;
    entry.name = parameter.name;
    entry.dimension = parameter.dimension;
    entry.prior_std = problem_.prior_stds[i];
    entry.planned_std = planned[i];
    entry.identified_combination =
        problem_.identifiability.decisions[column].identified_combination;
    result->parameters.push_back(std::move(entry));
  }
  ListTerms(planned, static_cast<int>(plan.chosen.size()), result);
}

// Where the poses bring less than three times what is known before, the
// deviation is more than half of the prior's; information grows with their
// number.
void PlanEvaluator::ListTerms(const Eigen::VectorXd& planned, int num_poses,
                              PlanResult* result) const {
  if (!problem_.terms) return;
  constexpr double kWanted = 3.0;
  const auto first = static_cast<Eigen::Index>(problem_.columns.size());
  for (const PlannedTerms::Entry& term : problem_.terms->entries()) {
    const double share = std::sqrt(
        planned.segment(first + term.first, term.count).cwiseAbs2().mean());
    PlannedErrorTerm entry;
    entry.name = term.name;
    entry.unit = term.unit;
    entry.prior_std = term.prior_std;
    entry.planned_std = share * term.prior_std;
    const double gained = 1.0 / (share * share) - 1.0;
    entry.poses_needed =
        gained > 0.0 ? static_cast<int>(std::ceil(num_poses * kWanted / gained))
                     : 0;
    result->terms.push_back(std::move(entry));
  }
}

double PlanEvaluator::BoundOf(int num_poses) const {
  const PoseMeasurement& measurement = config_.measurement;
  const bool is_plain = !measurement.orientation &&
                        measurement.num_equations() == 3 &&
                        measurement.targets == std::vector<int>{0};
  if (!is_plain || problem_.HasKnown()) return 0.0;
  return measurement.sigma * std::sqrt(num_parameters() / num_poses);
}

void PlanEvaluator::Evaluate(const DesignResult& plan,
                             PlanResult* result) const {
  const PoseRows& rows = problem_.design.candidates;
  const auto count = static_cast<int>(plan.chosen.size());
  ListParameters(plan, result);
  result->evaluations.push_back(EvaluatePoses("planned", rows, plan.chosen));
  result->evaluations.push_back(EvaluatePoses("greedy", rows, plan.greedy));
  result->evaluations.push_back(EvaluateRandom(count, result));
  if (result->measured_before > 0) {
    result->evaluations.push_back(EvaluatePoses("no new poses", rows, {}));
  }
  result->d_efficiency =
      DeterminantEfficiency(problem_.design, plan.chosen, threads());
  result->bound = BoundOf(count);
  result->exchanges = plan.exchanges;
  result->passes = plan.passes;
  result->value = plan.value;
  result->greedy_value = plan.greedy_value;
}

// Steps of the square root of two about the planned number.
std::vector<int> PlanEvaluator::CurveNumbers(int num_poses) const {
  if (!config_.curve.empty() || !config_.with_curve) return config_.curve;
  const double fewest =
      1.2 * num_parameters() / config_.measurement.num_equations();
  std::vector<int> numbers;
  for (int step = -8; step <= 2; ++step) {
    const auto number =
        static_cast<int>(std::lround(num_poses * std::pow(2.0, 0.5 * step)));
    if (number >= fewest && (numbers.empty() || number > numbers.back())) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

PredictedAccuracy PlanEvaluator::RandomAccuracy(int count) const {
  std::vector<double> worst, rms;
  for (int draw = 0; draw < kCurveDraws; ++draw) {
    const PredictedAccuracy accuracy =
        Predict(problem_.coarse_region,
                KnownWith(problem_.random, DrawPoses(count, draw)), threads());
    worst.push_back(accuracy.worst);
    rms.push_back(accuracy.rms);
  }
  return {Median(std::move(worst)), Median(std::move(rms))};
}

void PlanEvaluator::DrawCurve(const DesignResult& plan,
                              PlanResult* result) const {
  const auto count = static_cast<int>(plan.chosen.size());
  const std::vector<int> numbers = CurveNumbers(count);
  if (numbers.empty()) return;
  const DesignProblem part = WorstTold(problem_, plan, threads());
  DesignOptions options = config_.design;
  options.starts = 1;
  for (const int number : numbers) {
    PlanCurvePoint point;
    point.num_poses = number;
    point.bound = BoundOf(number);
    options.num_poses = number;
    const DesignResult design =
        number == count ? plan : ChoosePoses(part, options);
    if (!design.chosen.empty()) {
      point.planned =
          Predict(problem_.coarse_region, design.information, threads());
    }
    point.random = RandomAccuracy(number);
    result->curve.push_back(point);
  }
}

}  // namespace alidade::internal
