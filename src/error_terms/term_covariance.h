#ifndef ALIDADE_SRC_ERROR_TERMS_TERM_COVARIANCE_H_
#define ALIDADE_SRC_ERROR_TERMS_TERM_COVARIANCE_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "src/error_terms/term_columns.h"
#include "src/error_terms/term_rows.h"

namespace alidade::internal {

/// What a joint's function may be between its knots and beyond them, by its
/// prior.
struct FunctionGaps {
  FunctionKnots knots;
  double length = 0.0;    ///< of the prior
  double variance = 0.0;  ///< of the prior (kTermUnit^2)

  double VarianceAt(double joint_value) const {
    return variance * VarianceBesideKnots(knots, length, joint_value);
  }
};

/// What is not known of geometry and terms together.
struct TermCovariance {
  TermColumns columns;
  std::vector<int> geometry;  ///< columns of the layout
  /// Covariance = root root^T, geometry in mm and mrad first, then
  /// coefficients.
  Eigen::MatrixXd root;
  /// Of each function those of every rung that has a part in it.
  std::vector<FunctionGaps> gaps = {};

  /// Of a spread: columns of the root, then two for each function, of an
  /// observation's first and second pose.
  Eigen::Index width() const {
    return root.cols() +
           2 * static_cast<Eigen::Index>(columns.functions().size());
  }
  /// height x width(): S with S S^T the covariance of an observation's rows,
  /// the rows times the root and what functions do beside their knots.
  Eigen::MatrixXd Spread(const TermRows& rows,
                         const TermRows::Observation& observation) const;
};

/// The estimate of one rung, for the covariance of their stack.
struct RungEstimate {
  const TermColumns& columns;
  double weight = 0.0;              ///< in the stack
  Eigen::VectorXd values = {};      ///< geometry (mm, mrad), then coefficients
  Eigen::MatrixXd covariance = {};  ///< of these; not used without weight
  double function_variance = 0.0;   ///< of the functions' prior (kTermUnit^2)
};

/// The covariance of geometry + share (stack - geometry), the mean of all rungs
/// by their weights W, about the truth: within and between the rungs, as if
/// each were right with a probability proportional to W^2. Weights of least
/// squares are no probabilities: where two rungs disagree by d, and one has
/// almost all weight, the mean is off by (1 - W) d and not by the root of
/// W (1 - W) d^2. `all` can express the terms of all rungs,
/// of which the first is the geometry; `geometry`: columns of the layout.
/// O(size^3).
std::shared_ptr<const TermCovariance> CovarianceOfStack(
    const std::vector<RungEstimate>& rungs, double share,
    const TermColumns& all, const std::vector<int>& geometry);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_TERM_COVARIANCE_H_
