#ifndef ALIDADE_SRC_PLANNING_EFFICIENCY_H_
#define ALIDADE_SRC_PLANNING_EFFICIENCY_H_

#include <vector>

#include "src/planning/exchange.h"

namespace alidade::internal {

/// A part of the information (p-th root of det M) of the best plan of as many
/// of the candidates that the plan `chosen` has at least, between 0 and 1. As
/// log det M is concave, weights w of the candidates, of sum 1, bound that of
/// every plan of N poses:
///
///   log det M <= log det M_w + N (max_k v_k - sum_k w_k v_k),
///   M_w = M0 + N sum_k w_k J_k^T J_k,   v_k = trace J_k M_w^-1 J_k^T
///
/// (Kiefer and Wolfowitz 1960 for M0 = 0). The weights are improved from those
/// of the plan, each multiplied by its v_k again and again (Titterington 1976,
/// "Algorithms for computing D-optimal designs"); any weights give a bound, so
/// that it holds wherever this ends. A plan of few poses may be the best and
/// still be below 1, since weights may be fractions of a pose.
/// O(candidates p^2), and 100 times that for a part of the candidates.
/// @pre M of the plan is positive definite.
double DeterminantEfficiency(const DesignProblem& problem,
                             const std::vector<int>& chosen, int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_PLANNING_EFFICIENCY_H_
