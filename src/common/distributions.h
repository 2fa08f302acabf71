#ifndef ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_
#define ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_

#include <cstdint>
#include <utility>

namespace alidade::internal {

/// Distributions that intervals and tests need, as Boost.Math computes them, in
/// double precision and without exceptions: a quantile at the end of its range
/// is infinite. Degrees of freedom beyond 1e8 count as infinite, where the
/// distributions agree with their limits to about 1e-8.

/// P(Z <= z) of a standard normal Z.
double NormalCdf(double z);
/// z with NormalCdf(z) = probability; infinite at 0 and 1.
/// @pre 0 <= probability <= 1.
double NormalQuantile(double probability);

/// The chi-square distribution with `dof` degrees of freedom: of the sum of
/// that many squared standard normals. @pre dof > 0, finite.

/// P(X <= x); 0 for x <= 0.
double ChiSquareCdf(double x, double dof);
/// P(X > x) = 1 - ChiSquareCdf, without the loss of digits; 1 for x <= 0.
double ChiSquareSurvival(double x, double dof);
/// x with ChiSquareCdf(x, dof) = probability. @pre 0 <= probability <= 1.
double ChiSquareQuantile(double probability, double dof);
/// x with ChiSquareSurvival(x, dof) = survival, which may be as small as
/// 1e-300. @pre 0 <= survival <= 1.
double ChiSquareUpperQuantile(double survival, double dof);

/// Student's t: t with P(T <= t) = probability; `dof` may be infinite.
/// @pre dof > 0, 0 < probability < 1.
double StudentTQuantile(double probability, double dof);

/// Fisher's F: f with P(F <= f) = probability; `dof2` may be infinite.
/// @pre dof1, dof2 > 0; 0 <= probability < 1.
double FisherQuantile(double probability, double dof1, double dof2);
/// P(F > f) without the loss of digits; 1 for f <= 0.
double FisherSurvival(double f, double dof1, double dof2);

/// The interval of a rate of which `held` of `n` trials were seen (Clopper and
/// Pearson 1934): true rates outside would give such a count or a more extreme
/// one with less than half of 1 - confidence. {0, 1} for n = 0.
std::pair<double, double> RateInterval(std::int64_t held, std::int64_t n,
                                       double confidence);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_
