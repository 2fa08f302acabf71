#include "src/planning/exchange.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/common/parallel.h"
#include "src/common/random.h"
#include "src/planning/criterion.h"
#include "src/planning/plan_state.h"

namespace alidade::internal {
namespace {

// What an exchange must add to the logarithm of the criterion to count. Below,
// no predicted deviation changes in its fourth digit, and the more candidates
// there are, the longer such exchanges would go on.
constexpr double kSmallestGain = 1e-5;

// Stands for what nothing is known of, times the mean information of a pose
// about a parameter: so small that it does not weigh against one pose.
constexpr double kRelativeRidge = 1e-10;

// M is singular to rounding where the ridge holds a direction up.
constexpr double kRidgeHolds = 1e3;

// Candidates that most of the search is made among, for each pose of the plan,
// of all, and at least. What others could add is looked at in the end.
constexpr int kActiveForEach = 16;
constexpr int kActiveOfAll = 50;
constexpr int kFewestActive = 800;

// Rounds of exchanges among the active candidates, which change with the plan,
// before all are looked at.
constexpr int kActiveRounds = 8;

void SortWithoutRepeats(std::vector<int>* indices) {
  std::sort(indices->begin(), indices->end());
  indices->erase(std::unique(indices->begin(), indices->end()), indices->end());
}

// The exchange over one set of candidates, from the poses that a state has.
class Exchange {
 public:
  Exchange(const DesignProblem& problem, const DesignOptions& options,
           double ridge)
      : problem_(problem), options_(options), ridge_(ridge) {}

  // False: there are not as many poses that may stand beside each other.
  bool FillGreedily(std::vector<int>* chosen) const {
    PlanState state(problem_, options_, ridge_, *chosen);
    return FillGreedily(&state, chosen);
  }

  bool FillGreedily(PlanState* state, std::vector<int>* chosen) const {
    while (static_cast<int>(state->chosen().size()) < options_.num_poses) {
      const BestCandidate best = state->BestAddition();
      if (best.index < 0) return false;
      state->Add(best.index);
    }
    *chosen = state->chosen();
    return true;
  }

  // Other starts than the greedy one: half of the poses are drawn.
  bool StartRandomly(int start, std::vector<int>* chosen) const {
    Random random(options_.seed, static_cast<std::uint64_t>(start));
    PlanState state(problem_, options_, ridge_, {});
    const double count = problem_.candidates.size();
    for (int draw = 0; draw < options_.num_poses / 2; ++draw) {
      const auto candidate = static_cast<int>(random.Uniform() * count);
      if (state.IsAllowed(candidate, -1)) state.Add(candidate);
    }
    return FillGreedily(&state, chosen);
  }

  // Other criteria than D go on from its plan, or where starts are to differ,
  // from the poses that are there.
  void Improve(bool from_determinant, DesignResult* result) const {
    PlanState state(problem_, options_, ridge_, result->chosen);
    const bool by_determinant = options_.criterion == DesignCriterion::kD;
    if (by_determinant || from_determinant) RunPasses(true, &state, result);
    if (!by_determinant) RunPasses(false, &state, result);
    result->chosen = state.chosen();
    Evaluate(result);
  }

  // The candidates that would improve a plan in some place, in ascending order.
  std::vector<int> Improving(const std::vector<int>& chosen) const {
    const PlanState state(problem_, options_, ridge_, chosen);
    if (options_.criterion == DesignCriterion::kD) {
      return state.Improving(kSmallestGain);
    }
    CriterionEvaluator criterion(options_.criterion, problem_.region);
    std::vector<int> found;
    for (int place = 0; place < options_.num_poses; ++place) {
      const Values values = ValuesInPlace(place, state, &criterion);
      for (std::size_t k = 0; k < values.candidates.size(); ++k) {
        if (values.with[k] > values.now + kSmallestGain) {
          found.push_back(values.candidates[k]);
        }
      }
    }
    SortWithoutRepeats(&found);
    return found;
  }

  void Evaluate(DesignResult* result) const {
    result->information =
        problem_.known + InformationOf(problem_.candidates, result->chosen);
    result->value = CriterionValue(options_.criterion, result->information,
                                   problem_.region);
    if (IsSingular(result->information)) {
      result->value = -std::numeric_limits<double>::infinity();
    }
  }

 private:
  void RunPasses(bool by_determinant, PlanState* state,
                 DesignResult* result) const {
    result->status = DesignStatus::kPassLimit;
    CriterionEvaluator criterion(options_.criterion, problem_.region);
    for (int pass = 0; pass < options_.max_passes; ++pass) {
      ++result->passes;
      int exchanges = 0;
      for (int place = 0; place < options_.num_poses; ++place) {
        exchanges += by_determinant ? ImproveDeterminant(place, state)
                                    : ImproveValue(place, &criterion, state);
      }
      result->exchanges += exchanges;
      if (exchanges == 0) {
        result->status = DesignStatus::kConverged;
        return;
      }
      state->Refresh();
    }
  }

  static int ImproveDeterminant(int place, PlanState* state) {
    const BestCandidate best = state->BestReplacement(place);
    if (best.index < 0 || !(std::log(best.gain) > kSmallestGain)) return 0;
    state->Replace(place, best.index);
    return 1;
  }

  // A criterion of the plan, and with some candidates in one of its places.
  struct Values {
    double now = 0.0;
    std::vector<int> candidates;
    std::vector<double> with;
  };

  Values ValuesInPlace(int place, const PlanState& state,
                       CriterionEvaluator* criterion) const {
    const PoseRows& rows = problem_.candidates;
    const auto old_rows = rows.Pose(state.chosen()[place]);
    criterion->SetBase(state.information() - old_rows * old_rows.transpose());
    Values values;
    values.now = criterion->Value(state.information());
    values.candidates = state.Shortlist(criterion->Slope(state.information()),
                                        place, options_.shortlist);
    values.with.resize(values.candidates.size());
    const auto work = [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        values.with[i] = criterion->ValueWith(rows.Pose(values.candidates[i]));
      }
    };
    ParallelFor(options_.num_threads,
                static_cast<std::int64_t>(values.with.size()), 1, work);
    return values;
  }

  int ImproveValue(int place, CriterionEvaluator* criterion,
                   PlanState* state) const {
    const Values values = ValuesInPlace(place, *state, criterion);
    const auto best = std::max_element(values.with.begin(), values.with.end());
    if (best == values.with.end() || !(*best > values.now + kSmallestGain)) {
      return 0;
    }
    state->Replace(place, values.candidates[best - values.with.begin()]);
    return 1;
  }

  bool IsSingular(const Eigen::MatrixXd& information) const {
    return !(CriterionValue(DesignCriterion::kE, information, {}) >
             std::log(kRidgeHolds * ridge_));
  }

  const DesignProblem& problem_;
  const DesignOptions& options_;
  const double ridge_;
};

// Positions of `chosen` in the ascending list `all`, which has them.
std::vector<int> PlacesIn(const std::vector<int>& all,
                          const std::vector<int>& chosen) {
  std::vector<int> places;
  for (const int candidate : chosen) {
    places.push_back(static_cast<int>(
        std::lower_bound(all.begin(), all.end(), candidate) - all.begin()));
  }
  return places;
}

// The candidates that a plan determines worst, its own and `more`.
std::vector<int> ActiveCandidates(const DesignProblem& problem,
                                  const DesignOptions& options, double ridge,
                                  const std::vector<int>& chosen,
                                  const std::vector<int>& more) {
  const PlanState state(problem, options, ridge, chosen);
  std::vector<int> active = state.MostInformative(
      std::max({kFewestActive, kActiveForEach * options.num_poses,
                problem.candidates.size() / kActiveOfAll}));
  active.insert(active.end(), chosen.begin(), chosen.end());
  active.insert(active.end(), more.begin(), more.end());
  SortWithoutRepeats(&active);
  return active;
}

// The best of all starts over a part of the candidates; `greedy` is the first.
DesignResult BestOfStarts(const Exchange& exchange,
                          const DesignOptions& options,
                          const std::vector<int>& greedy) {
  DesignResult best;
  std::vector<double> values;
  for (int start = 0; start < options.starts; ++start) {
    DesignResult result;
    result.chosen = greedy;
    if (start > 0 && !exchange.StartRandomly(start, &result.chosen)) continue;
    exchange.Improve(start == 0, &result);
    values.push_back(result.value);
    if (start == 0 || result.value > best.value) best = std::move(result);
  }
  best.start_values = std::move(values);
  return best;
}

// Exchanges among the candidates that the plan determines worst and `more`,
// again and again.
void ImproveAmongActive(const DesignProblem& problem,
                        const DesignOptions& options, double ridge,
                        const std::vector<int>& more, DesignResult* result) {
  for (int round = 0; round < kActiveRounds; ++round) {
    const std::vector<int> active =
        ActiveCandidates(problem, options, ridge, result->chosen, more);
    const DesignProblem part = RestrictCandidates(problem, active);
    const int exchanges = result->exchanges;
    result->chosen = PlacesIn(active, result->chosen);
    Exchange(part, options, ridge).Improve(false, result);
    for (int& candidate : result->chosen) candidate = active[candidate];
    if (result->exchanges == exchanges) return;
  }
}

// Until no candidate of all would improve the plan. Those that would are active
// from then on: how often all are looked at hardly depends on how many they
// are.
void ImproveAmongAll(const DesignProblem& problem, const DesignOptions& options,
                     double ridge, DesignResult* result) {
  const Exchange exchange(problem, options, ridge);
  std::vector<int> found;
  for (int pass = 0; pass < options.max_passes; ++pass) {
    ImproveAmongActive(problem, options, ridge, found, result);
    const std::vector<int> improving = exchange.Improving(result->chosen);
    result->status =
        improving.empty() ? DesignStatus::kConverged : DesignStatus::kPassLimit;
    if (improving.empty()) return;
    found.insert(found.end(), improving.begin(), improving.end());
  }
}

}  // namespace

DesignResult ChoosePoses(const DesignProblem& problem,
                         const DesignOptions& options) {
  const PoseRows& rows = problem.candidates;
  const double ridge = kRelativeRidge * rows.transposed.squaredNorm() /
                       static_cast<double>(rows.size()) / rows.num_parameters();
  const Exchange exchange(problem, options, ridge);
  DesignResult greedy;
  if (!exchange.FillGreedily(&greedy.chosen)) return {};
  exchange.Evaluate(&greedy);

  const std::vector<int> active =
      ActiveCandidates(problem, options, ridge, greedy.chosen, {});
  const DesignProblem part = RestrictCandidates(problem, active);
  DesignResult result = BestOfStarts(Exchange(part, options, ridge), options,
                                     PlacesIn(active, greedy.chosen));
  for (int& candidate : result.chosen) candidate = active[candidate];
  ImproveAmongAll(problem, options, ridge, &result);
  result.greedy = std::move(greedy.chosen);
  result.greedy_value = greedy.value;
  if (std::isinf(result.value)) result.status = DesignStatus::kRankShort;
  std::sort(result.chosen.begin(), result.chosen.end());
  return result;
}

Eigen::VectorXd PredictedVariances(const PoseRows& rows,
                                   const Eigen::MatrixXd& information,
                                   int num_threads) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information);
  const Eigen::Index m = rows.rows_each;
  Eigen::VectorXd variances(rows.size());
  const auto work = [&](std::int64_t begin, std::int64_t end) {
    const Eigen::MatrixXd halves = cholesky.matrixL().solve(
        rows.transposed.middleCols(begin * m, (end - begin) * m));
    for (std::int64_t k = begin; k < end; ++k) {
      variances[k] = halves.middleCols((k - begin) * m, m).squaredNorm();
    }
  };
  ParallelFor(num_threads, rows.size(), kCandidatesPerBlock, work);
  return variances;
}

}  // namespace alidade::internal
