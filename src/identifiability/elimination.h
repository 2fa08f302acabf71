#ifndef ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_
#define ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_

#include <Eigen/Core>
#include <vector>

namespace alidade::internal {

/// A column that the kept ones before it can replace.
struct DependentColumn {
  int index = 0;                 ///< of the column
  Eigen::VectorXd coefficients;  ///< of the kept columns, in their order
  bool is_zero = false;          ///< it has no effect at all
};

struct Elimination {
  std::vector<int> kept;
  std::vector<DependentColumn> dependent;
};

/// Walks through the columns of a (scaled) factor in the order given and keeps
/// each that the ones kept before cannot replace: the part of it that is
/// orthogonal to them is above `tolerance` times its own norm. A column below
/// `tolerance` times the largest counts as zero.
///
/// Where the rank is clear, what is kept and the coefficients depend on the
/// null space and the order alone, not on the poses that the factor was made
/// from. O(columns^3).
Elimination Eliminate(const Eigen::MatrixXd& factor, double tolerance);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_IDENTIFIABILITY_ELIMINATION_H_
