#ifndef ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_
#define ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_

#include <Eigen/Core>
#include <vector>

namespace alidade::internal {

/// A column that the kept ones before it can replace.
struct DependentColumn {
  int index = 0;                 ///< of the column
  Eigen::VectorXd coefficients;  ///< of all kept columns, in their order
  bool is_zero = false;          ///< it has no effect at all
};

struct Elimination {
  std::vector<int> kept;
  std::vector<DependentColumn> dependent;
  double tolerance = 0.0;  ///< as given
};

/// Chooses a basis among the columns of a (scaled) factor: walks through them
/// in the order given and keeps each that the ones kept before cannot replace,
/// the part of it that is orthogonal to them being above `tolerance` times its
/// own norm. A column below `tolerance` times the largest counts as zero.
///
/// Two columns that are nearly parallel may both have been kept then, and a
/// third be their difference many times over: a basis in which the values are
/// badly determined. So as long as a column that is left out depends on a kept
/// one with a coefficient above kLargestCoefficient, the two change places,
/// which multiplies the basis' volume by that coefficient (strong
/// rank-revealing QR; Gu and Eisenstat 1996, "Efficient algorithms for
/// computing a strong rank-revealing QR factorization", algorithm 4). The order
/// thus decides among bases that are equally good. The first `num_protected`
/// columns never leave.
///
/// Where the rank is clear, what is kept and the coefficients depend on the
/// null space and the order alone, not on the poses that the factor was made
/// from. O(columns^3) for each exchange.
inline constexpr double kLargestCoefficient = 5.0;
Elimination Eliminate(const Eigen::MatrixXd& factor, double tolerance,
                      int num_protected = 0);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_
