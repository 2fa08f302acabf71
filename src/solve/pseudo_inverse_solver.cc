#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

#include "alidade/solve/solver.h"
#include "progress.h"

namespace alidade {
namespace {

using Svd = Eigen::BDCSVD<Eigen::MatrixXd>;

// Singular values of later steps that are left to count: all but rounding.
// What second-order effects tell apart grows from zero as the geometry leaves
// its nominal values, so no fixed tolerance in the gap at the start would do.
constexpr double kLaterTolerance = 1e-12;

// The number of singular values that count at one step.
Eigen::Index CountedRank(const Eigen::VectorXd& singular_values,
                         double tolerance) {
  return (singular_values.array() > tolerance * singular_values[0]).count();
}

// W = Q R, and the singular value decomposition of the small R: that of W, at
// a cost that grows with the poses only in the one pass that makes R.
struct Decomposition {
  Svd svd;
  Eigen::VectorXd rotated_residuals;  // the first p entries of Q^T r
};

Decomposition Decompose(const Linearization& linearization) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(linearization.jacobian);
  const Eigen::Index p = linearization.jacobian.cols();
  const Eigen::MatrixXd factor =
      qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
  const Eigen::VectorXd rotated =
      qr.householderQ().adjoint() * linearization.residuals;
  return {Svd(factor, Eigen::ComputeThinU | Eigen::ComputeThinV),
          rotated.head(p)};
}

// The least-squares step of minimum norm, W+ r, with the first `rank` singular
// values.
Eigen::VectorXd PseudoInverseStep(const Decomposition& decomposition,
                                  Eigen::Index rank) {
  const Svd& svd = decomposition.svd;
  const Eigen::VectorXd& singular_values = svd.singularValues();
  const Eigen::VectorXd rotated = svd.matrixU().leftCols(rank).transpose() *
                                  decomposition.rotated_residuals;
  return svd.matrixV().leftCols(rank) *
         rotated.cwiseQuotient(singular_values.head(rank));
}

}  // namespace

SolverSummary SolvePseudoInverse(const CalibrationProblem& problem,
                                 const SolverOptions& options,
                                 Eigen::VectorXd* values) {
  Progress progress(problem, options, "pseudo_inverse");
  Eigen::VectorXd current = *values;
  progress.Start(current);
  const bool automatic = options.pseudo_inverse_tolerance == 0.0;
  const double tolerance =
      automatic ? kLaterTolerance : options.pseudo_inverse_tolerance;
  progress.summary().pseudo_inverse_tolerance_used = tolerance;
  Linearization linearization;
  while (!progress.stopped()) {
    problem.model.Linearize(current, problem.data, problem.free_columns,
                            &linearization);
    if (!linearization.jacobian.allFinite()) {
      progress.Stop(SolverStatus::kFailed, "the Jacobian is not finite");
      break;
    }
    const Decomposition decomposition = Decompose(linearization);
    const Eigen::VectorXd& singular_values = decomposition.svd.singularValues();
    if (!(singular_values[0] > 0.0)) {
      progress.Stop(SolverStatus::kFailed,
                    "no measured position depends on a free parameter");
      break;
    }
    Eigen::Index rank = CountedRank(singular_values, tolerance);
    if (progress.summary().first_step_rank < 0) {
      const Eigen::Index start_rank = problem.start_rank.rank;
      if (automatic && start_rank > 0) rank = std::min(rank, start_rank);
      progress.summary().first_step_rank = static_cast<int>(rank);
    }
    const Eigen::VectorXd step = PseudoInverseStep(decomposition, rank);
    for (Eigen::Index k = 0; k < step.size(); ++k) {
      current[problem.free_columns[k]] -= step[k];
    }
    progress.Record(
        {step.norm(), true, (linearization.jacobian * step).squaredNorm()},
        current);
  }
  progress.Finish();
  if (progress.summary().IsSolutionUsable()) *values = current;
  return progress.summary();
}

}  // namespace alidade
