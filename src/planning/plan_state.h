#ifndef ALIDADE_SRC_PLANNING_PLAN_STATE_H_
#define ALIDADE_SRC_PLANNING_PLAN_STATE_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/plan.h"
#include "src/planning/criterion.h"
#include "src/planning/design_problem.h"

namespace alidade::internal {

/// A candidate and what it was found by; none: -1.
struct BestCandidate {
  double gain = 0.0;
  int index = -1;
};

/// Makes a search of candidates the same for any number of threads.
inline constexpr int kCandidatesPerBlock = 256;

/// A plan under construction: M, its inverse, and V_k = J_k M^-1 J_k^T of every
/// candidate (exchange.h), updated as poses come and go.
class PlanState {
 public:
  /// A plan of the poses `chosen`, without conflicts. `ridge` is added to the
  /// diagonal of M0. Problem and options outlive the object.
  PlanState(const DesignProblem& problem, const DesignOptions& options,
            double ridge, std::vector<int> chosen);

  const std::vector<int>& chosen() const { return chosen_; }
  const Eigen::MatrixXd& information() const { return information_; }
  const Eigen::MatrixXd& inverse() const { return inverse_; }

  /// Adds a pose; puts another one into a place of the plan.
  void Add(int candidate);
  void Replace(int place, int candidate);

  /// The candidate that, added, multiplies det M by most; `gain` is that
  /// factor.
  BestCandidate BestAddition() const;
  /// The candidate that, in this place, leaves the largest det M; `gain` is
  /// relative to the pose that is there, 1 or more. None where the others do
  /// not determine all parameters.
  BestCandidate BestReplacement(int place) const;

  /// The candidates that would add more than `smallest_gain` to log det M in
  /// some place of the plan, in ascending order. O(p N m^2) each, N poses of m
  /// rows in the plan; determinants are taken only where
  ///
  ///   det(I + V_k') <= (1 + tr V_k' / m)^m,
  ///
  /// V_k' without the pose of the place, lets expect that they are large
  /// enough.
  std::vector<int> Improving(double smallest_gain) const;

  /// The candidates with the largest scores sum_i weights_i |J f_i|^2, largest
  /// first; those that may be in this place of the plan.
  std::vector<int> Shortlist(const DesignSlope& slope, int place,
                             int count) const;

  /// The candidates with the largest det(I + V_k), in ascending order.
  std::vector<int> MostInformative(int count) const;

  /// Whether a candidate may be in a place of the plan (-1: an additional one).
  bool IsAllowed(int candidate, int place) const;

  /// Takes inverse and V_k from M anew: updates add up rounding errors.
  void Refresh();

 private:
  // A pose that goes or comes: U of M^-1 -+ U U^T.
  Eigen::MatrixXd UpdateOf(int candidate, double sign, double* pivot) const;
  void Change(int candidate, double sign);
  BestCandidate BestBy(const Eigen::MatrixXd& removal, int place) const;
  // det(I + V_i') of the pose in a place, itself taken out of M.
  double OwnGain(int place, const Eigen::MatrixXd& removal) const;
  struct Vacancies;
  Vacancies TakeOut(double smallest_gain) const;
  bool Improves(int candidate, const Vacancies& vacancies,
                const Eigen::Ref<const Eigen::MatrixXd>& products) const;
  void Count(int candidate, int change);
  bool Conflicts(int candidate, int other) const;

  const DesignProblem& problem_;
  const DesignOptions& options_;
  const int rows_each_;
  std::vector<int> chosen_;
  Eigen::MatrixXd information_;
  Eigen::MatrixXd inverse_;
  Eigen::MatrixXd variances_;  ///< rows_each x rows_each * candidates
  /// Poses of the plan that a candidate may not stand beside; empty: none ever.
  std::vector<int> conflicts_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_PLAN_STATE_H_
