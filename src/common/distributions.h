#ifndef ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_
#define ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_

#include <cstdint>
#include <utility>

namespace alidade::internal {

/// Distributions that intervals and tests need; the chi-square distribution has
/// its own header. Relative errors are below 1e-12 for parameters up to 1e3 and
/// below 1e-8 for those up to 1e8; parameters beyond 1e8 count as infinite.

/// P(Z <= z) of a standard normal Z.
double NormalCdf(double z);
/// z with NormalCdf(z) = probability; infinite at 0 and 1. Newton's method on
/// the log of the smaller tail. @pre 0 <= probability <= 1.
double NormalQuantile(double probability);

/// The regularised incomplete beta function I_x(a, b), the cumulative
/// distribution of a beta variable, by Lentz's evaluation of its continued
/// fraction (DLMF 8.17.22). @pre a, b > 0; 0 <= x <= 1.
double BetaCdf(double x, double a, double b);
/// x with BetaCdf(x, a, b) = probability.
double BetaQuantile(double probability, double a, double b);

/// Student's t: t with P(T <= t) = probability; `dof` may be infinite.
/// @pre dof > 0, 0 < probability < 1.
double StudentTQuantile(double probability, double dof);

/// Fisher's F: f with P(F <= f) = probability; `dof2` may be infinite.
/// @pre dof1, dof2 > 0; 0 <= probability < 1.
double FisherQuantile(double probability, double dof1, double dof2);

/// The interval of a rate of which `held` of `n` trials were seen (Clopper and
/// Pearson 1934): true rates outside would give such a count or a more extreme
/// one with less than half of 1 - confidence. {0, 1} for n = 0.
std::pair<double, double> RateInterval(std::int64_t held, std::int64_t n,
                                       double confidence);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_DISTRIBUTIONS_H_
