#ifndef ALIDADE_SRC_UNCERTAINTY_RESIDUAL_STRUCTURE_H_
#define ALIDADE_SRC_UNCERTAINTY_RESIDUAL_STRUCTURE_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "alidade/uncertainty.h"
#include "src/uncertainty/residual_gram.h"

namespace alidade::internal {

/// The fit of the free parameters to the looks, and with some of the structure
/// columns beside them. With A = J^T J + P^-1, b = J^T r + P^-1 (value -
/// nominal), all of looks:
///
///   freedom   rows - trace(A^-1 J^T J)
///   S         Z^T Z - Z^T J A^-1 J^T Z: what of the columns no parameter takes
///   s         Z^T r - Z^T J A^-1 b
///
/// Columns that are dependent, on parameters or each other, to 1e-6 of their
/// squared norms are left out.
// The analyzer takes a copy of one for a copy of nothing.
// NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign)
class StructureFit {
 public:
  StructureFit(const FittedProblem& fit, const ResidualGram& gram);

  /// Of a class of rows: the sum of squares of the residuals, and how many
  /// degrees of freedom it has, with what has been added so far.
  double Squares(int which) const;
  double Freedom(int which) const;
  double AllSquares() const { return squares_; }
  double AllFreedom() const { return freedom_; }

  /// By how much the sum of squares falls with more columns, and their rank.
  struct Gain {
    double squares = 0.0;
    int rank = 0;
  };
  Gain GainOf(const std::vector<int>& columns) const;
  void AddColumns(const std::vector<int>& columns);

 private:
  // Those of some columns that something is left of.
  std::vector<int> Independent(const std::vector<int>& columns) const;

  const ResidualGram& gram_;
  Eigen::Index p_ = 0;
  Eigen::MatrixXd inverse_;  // of A
  Eigen::VectorXd b_;        // of the parameters
  Eigen::MatrixXd all_;      // products of all rows
  Eigen::MatrixXd schur_;    // S
  Eigen::VectorXd right_;    // s
  Eigen::VectorXd norms_;    // squared, of the columns of Z
  std::vector<int> added_;
  int rank_added_ = 0;
  double squares_ = 0.0;
  double freedom_ = 0.0;
};

/// Tests every family, the strongest (by the Bayesian information criterion)
/// first, and again those that are left after it is added to `fit`, until none
/// is significant: F tests, p-values corrected for the number of tests. What
/// explains less than 2 % of the squares is not found, however certain. Nothing
/// where fewer than 10 degrees of freedom would be left.
///
/// Where nothing is there, one is found in at most 0.5 % of calibrations.
std::vector<StructureTest> FindStructure(
    const std::vector<StructureFamily>& families, StructureFit* fit);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_RESIDUAL_STRUCTURE_H_
