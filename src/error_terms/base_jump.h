#ifndef ALIDADE_SRC_ERROR_TERMS_BASE_JUMP_H_
#define ALIDADE_SRC_ERROR_TERMS_BASE_JUMP_H_

#include <optional>

#include "src/error_terms/term_normal.h"

namespace alidade::internal {

/// The arm's base, or the instrument, moved between two poses.
struct BaseJump {
  int pose = 0;           ///< the first after it
  double distance = 0.0;  ///< in whitened rows: root mean square that it moves
  double false_alarm = 1.0;
};

/// Jumps that noise has more often are none.
constexpr double kJumpFalseAlarm = 1e-4;

/// The pose before which a move of the base explains most of the residuals of a
/// fit that has one base for all, in the order of poses. With B the columns of
/// the base's six motions over the rows after it, S = B^T B of these and of all
/// rows, b = B^T r of those after it, the gain of a second base is
///
///   b^T (S_after - S_after S_all^-1 S_after)^-1 b / variance
///
/// chi-square of six degrees of freedom without a jump; of the places that are
/// looked at the best counts (Quandt 1960, with Bonferroni's bound). Nothing
/// where it is not below kJumpFalseAlarm. O(rows).
std::optional<BaseJump> FindBaseJump(const WeightedRows& data,
                                     const Eigen::VectorXd& residuals);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_BASE_JUMP_H_
