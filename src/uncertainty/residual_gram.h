#ifndef ALIDADE_SRC_UNCERTAINTY_RESIDUAL_GRAM_H_
#define ALIDADE_SRC_UNCERTAINTY_RESIDUAL_GRAM_H_

#include <Eigen/Core>
#include <array>

#include "src/uncertainty/covariance.h"
#include "src/uncertainty/looks.h"
#include "src/uncertainty/structure_columns.h"

namespace alidade::internal {

/// Products of [J Z r] over all looks: J the whitened Jacobian of the free
/// columns, Z the structure columns, r the residuals (the means of repeats).
/// With a robust loss rows are scaled by the root of their weight.
struct ResidualGram {
  /// (p + m + 1) square, of rows of lengths and of orientations.
  std::array<Eigen::MatrixXd, 2> products;
  std::array<double, 2> rows{};  ///< measured, each counted by its weight
  /// Sum of 1 / sigma^2 over these (1 / m^2, 1 / rad^2).
  std::array<double, 2> precision{};
  std::array<double, 2> inverse_counts{};  ///< sum of 1 / count over these
  /// J^T J of all observations, repeats each counted.
  Eigen::MatrixXd information;
  /// Sum of A^T A, A what an error of one unit that all repeats of a look have
  /// in common does to J^T r: per variance of a length, and of an orientation.
  std::array<Eigen::MatrixXd, 2> common;
  /// J^T r of each configuration, each residual freed of its own part in the
  /// fit (Bell and McCaffrey's CR2), p x configurations.
  Eigen::MatrixXd scores;
};

/// One pass over the looks. Bits do not depend on threads. `root`: of the
/// covariance of the free columns.
ResidualGram SumLooks(const FittedProblem& fit, const Looks& looks,
                      const StructureColumns& structure,
                      const Eigen::MatrixXd& root);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_RESIDUAL_GRAM_H_
