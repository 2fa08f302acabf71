#ifndef ALIDADE_ROBUST_LOSS_H_
#define ALIDADE_ROBUST_LOSS_H_

#include <vector>

namespace alidade {

/// How the cost of a measurement grows with s, the squared norm of its
/// whitened residual (so s and c have no unit):
///
///   kNone    s
///   kHuber   s up to c^2, 2 c sqrt(s) - c^2 beyond: convex, every residual
///            keeps a pull, of c at most
///   kCauchy  c^2 log(1 + s / c^2): the pull fades as 1 / sqrt(s)
///   kTukey   c^2 / 3 (1 - (1 - s / c^2)^3) up to c^2, constant beyond: no
///            pull at all from gross errors, and local minima, so that it
///            needs a good start
enum class LossKind { kNone, kHuber, kCauchy, kTukey };

/// A robust loss rho with rho(0) = 0 and rho'(0) = 1, as Ceres defines them
/// (ceres/loss_function.h): the cost is the sum of rho(|r|^2), halved in
/// Ceres. No state besides the two members; any thread may share one.
struct RobustLoss {
  LossKind kind = LossKind::kNone;
  /// c, the residual norm where the loss departs from squares; not used by
  /// kNone. TuningConstant gives the usual one. @pre > 0, finite.
  double tuning_constant = 1.0;

  /// rho, rho' and rho'' at s; rho'' <= 0. At s = c^2 rho and rho' are
  /// continuous; rho'' of Huber's loss is not and is that from below.
  /// @pre s >= 0, finite.
  void Evaluate(double s, double rho[3]) const;

  /// rho'(s), in (0, 1] (0 for kTukey beyond c^2): the factor of the squared
  /// residual in iteratively reweighted least squares. @pre as of Evaluate.
  double Weight(double s) const;
};

/// The constant c at which the loss costs 5 % of efficiency where there are no
/// outliers: the M-estimate of a location in d = `dimension` dimensions from
/// residuals r ~ N(0, I), with the weight w(|r|) = rho'(|r|^2), has the
/// asymptotic efficiency
///
///   eff(c) = d E[w + |r| w'(|r|) / d]^2 / E[w^2 |r|^2] = 0.95
///
/// against the mean (Maronna 1976, "Robust M-Estimators of Multivariate
/// Location and Scatter"; for d = 1 Huber 1964). The expectations are
/// Gauss-Legendre sums over the density of |r|, the chi density; c follows by
/// bisection, to ten digits. Well known for d = 1: Huber 1.345, Cauchy 2.385,
/// Tukey 4.685.
///
/// In many dimensions Huber's loss (d >= 10) and Cauchy's (d >= 40) are that
/// efficient for any c; they get a tenth of MedianOfChi. Infinity for kNone.
/// About a millisecond and no state: keep the result.
/// @pre dimension >= 1.
double TuningConstant(LossKind kind, int dimension);

/// The losses of observations of 1 to 6 rows, entry d - 1 tuned for d rows;
/// none at all for kNone. Tuned at the first call, kept from then on.
std::vector<RobustLoss> TunedLosses(LossKind kind);

/// The median norm of N(0, I) in d = `dimension` dimensions,
/// sqrt(ChiSquareQuantile(0.5, d)): 0.6745 for d = 1. @pre dimension >= 1.
double MedianOfChi(int dimension);

/// By what common factor the standard deviations that whitened the residuals
/// are too small: median(norms) / MedianOfChi(dimension), from the norms of
/// the residuals of single measurements. 1 in expectation for Gaussian
/// residuals whitened rightly. Its breakdown point is 50 %: outliers fewer
/// than half of the norms, however large, cannot carry it away, though they
/// raise it (40 % of them to the 5/6 quantile of the others over their
/// median). 0 for no norms. O(n). @pre norms >= 0; dimension >= 1.
double RobustScale(std::vector<double> norms, int dimension);

}  // namespace alidade

#endif  // ALIDADE_ROBUST_LOSS_H_
