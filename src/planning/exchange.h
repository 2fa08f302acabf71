#ifndef ALIDADE_SRC_PLANNING_EXCHANGE_H_
#define ALIDADE_SRC_PLANNING_EXCHANGE_H_

#include <Eigen/Core>
#include <vector>

#include "alidade/plan.h"
#include "src/planning/design_problem.h"

namespace alidade::internal {

enum class DesignStatus {
  /// No exchange of one pose makes it better; of criteria other than D, none
  /// with a candidate of that place's shortlist.
  kConverged,
  kPassLimit,  ///< max_passes came before that
  /// The poses do not determine all parameters, and nothing else is known of
  /// them: more poses, fewer parameters or priors are needed.
  kRankShort,
  /// Fewer poses than wanted can be chosen without repeats, or without coming
  /// nearer to each other than the minimum motion.
  kTooFew,
};

struct DesignResult {
  DesignStatus status = DesignStatus::kTooFew;
  std::vector<int> chosen;      ///< candidates, ascending, repeats side by side
  Eigen::MatrixXd information;  ///< M
  double value = 0.0;           ///< CriterionValue of the plan
  /// The greedy plan of the first start, before exchanges, and its value.
  std::vector<int> greedy;
  double greedy_value = 0.0;
  std::vector<double> start_values;  ///< before the last passes
  int exchanges = 0;                 ///< of the best start
  int passes = 0;
};

/// A greedy start and exchanges. Greedily, the pose that adds most to log det M
/// is added until there are N (Dykstra 1971), a small ridge standing for what
/// is not known yet. Then every pose of the plan in turn is replaced by the
/// candidate that makes the criterion largest, until no replacement does
/// (Fedorov 1972, in the order of Cook and Nachtsheim 1980, "A comparison of
/// algorithms for constructing exact D-optimal designs"). Where there are many,
/// all starts exchange among the candidates that the greedy plan determines
/// worst. For the best start all are looked at again and again: those that
/// would improve the plan in some place join the exchange, until there are
/// none. What adds less than 1e-5 to the criterion's logarithm does not count.
///
/// D: V_k = J_k M^-1 J_k^T of every candidate is kept. With
/// U U^T = M^-1 J^T (I -+ V)^-1 J M^-1 of the pose that goes or comes,
///
///   V_k(after) = V_k +- (J_k U)(J_k U)^T,   det M' / det M = det(I + V_k),
///
/// so that an exchange costs O(candidates p) for each row.
/// All other criteria: the slope of the criterion (DesignSlope) says which
/// candidates are worth an evaluation by eigenvalues or over the region, in
/// O(candidates p^2). Others are not tried, in the end neither. Ties go to the
/// candidate with the smaller number; bits do not depend on threads.
/// @pre options.IsValid(); sizes agree; there is a candidate.
DesignResult ChoosePoses(const DesignProblem& problem,
                         const DesignOptions& options);

/// trace J_k M^-1 J_k^T of every pose: its predicted variance in units of
/// sigma^2. For the rows of positions in m this is the predicted variance of
/// the position (m^2), summed over the axes. O(poses p^2).
/// @pre `information` is positive definite.
Eigen::VectorXd PredictedVariances(const PoseRows& rows,
                                   const Eigen::MatrixXd& information,
                                   int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_EXCHANGE_H_
