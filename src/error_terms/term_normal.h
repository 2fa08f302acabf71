#ifndef ALIDADE_SRC_ERROR_TERMS_TERM_NORMAL_H_
#define ALIDADE_SRC_ERROR_TERMS_TERM_NORMAL_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_rows.h"

namespace alidade::internal {

/// Observations of rows with their weights (of squares).
struct WeightedRows {
  const TermRows& rows;
  Eigen::VectorXd weights;  ///< one per observation
};

/// [J Z r]^T [J Z r] over some observations: geometry, terms, residual. O(rows
/// (p + dense)^2), since a row touches two knots of a function only.
Eigen::MatrixXd TermGram(const WeightedRows& data, const TermColumns& columns,
                         const std::vector<int>& observations);

/// Z c of one observation; height x 1.
Eigen::VectorXd ApplyTerms(const TermRows& rows, const TermColumns& columns,
                           const Eigen::VectorXd& coefficients,
                           const TermRows::Observation& observation);

/// Decimal logarithms of the prior precisions of each group, in coefficients'
/// units over the variance of the residual.
using LogPrecisions = std::array<double, kNumTermGroups>;

/// The estimate of geometry and terms, and how much is not known of it.
struct TermSolution {
  Eigen::VectorXd geometry;  ///< change of the parameters (mm, mrad)
  Eigen::VectorXd terms;
  double cost = 0.0;
  double log_determinant = 0.0;
};

/// Precisions, and what speaks for the terms that have them.
struct ChosenScales {
  LogPrecisions precisions = {};
  /// -2 log of the restricted likelihood but for a constant of the data:
  /// comparable between sets of terms beside the same geometry.
  double criterion = 0.0;
};

/// Ridge regression of geometry and terms,
///
///   min |r + J g + Z c|^2 + |D (deviation + g)|^2 + sum_groups lambda c^T P c
///
/// with the geometry's priors D and P the inverse correlation of a function's
/// knots, or 1 (Lindley and Smith 1972; for functions Rasmussen and Williams
/// 2006, 2.7).
class TermRidge {
 public:
  /// `deviations` and `priors` of the geometry's columns from nominal (mm,
  /// mrad), infinite where there is none.
  TermRidge(const TermColumns& columns, Eigen::VectorXd deviations,
            const Eigen::VectorXd& priors);

  int num_geometry() const { return static_cast<int>(deviations_.size()); }
  /// `gram`: TermGram. Zeros at infinite cost where the matrix is not positive
  /// definite.
  TermSolution Solve(const Eigen::MatrixXd& gram,
                     const LogPrecisions& precisions) const;
  /// The inverse of the penalised matrix: the posterior covariance for
  /// residuals of variance 1.
  Eigen::MatrixXd Covariance(const Eigen::MatrixXd& gram,
                             const LogPrecisions& precisions) const;

  /// The precisions of largest restricted likelihood, the variance of the
  /// residuals profiled out,
  ///
  ///   -2 log L = f log(cost / f) + log det(N + Lambda)
  ///              - sum (size log lambda + log det P)
  ///
  /// with f equations less the columns of the geometry (Patterson and Thompson
  /// 1971), by coordinate search with steps 2, 1, 0.5 from `start`.
  ChosenScales Choose(const Eigen::MatrixXd& gram, double equations,
                      const LogPrecisions& start) const;
  /// Groups that have columns.
  std::vector<TermGroup> Groups() const;

 private:
  // What is left of a problem once the knots are eliminated, for one precision
  // of the functions: all others may then change at little cost.
  struct Eliminated {
    Eigen::MatrixXd matrix;    // Schur complement, without precisions
    Eigen::VectorXd gradient;  // of geometry and dense terms
    double cost = 0.0;
    double log_determinant = 0.0;
    bool is_definite = true;
  };

  Eigen::MatrixXd Penalised(const Eigen::MatrixXd& gram,
                            const LogPrecisions& precisions) const;
  void AddFunctionPrecisions(double log_precision, Eigen::Index first,
                             Eigen::MatrixXd* matrix) const;
  void AddDensePrecisions(const LogPrecisions& precisions,
                          Eigen::MatrixXd* matrix) const;
  Eliminated Eliminate(const Eigen::MatrixXd& gram, double log_precision) const;
  double Criterion(const Eliminated& rest, double freedom,
                   const LogPrecisions& precisions) const;

  const TermColumns& columns_;
  Eigen::VectorXd deviations_;
  Eigen::VectorXd geometry_precisions_;
  std::array<int, kNumTermGroups> sizes_ = {};
  std::vector<Eigen::MatrixXd> function_precisions_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_TERM_NORMAL_H_
