#ifndef ALIDADE_SRC_COMMON_CHI_SQUARE_H_
#define ALIDADE_SRC_COMMON_CHI_SQUARE_H_

namespace alidade::internal {

/// The chi-square distribution with `dof` degrees of freedom: of the sum of
/// that many squared standard normals. With a = dof / 2 and the regularised
/// incomplete gamma functions P and Q = 1 - P,
///
///   P(X <= x) = P(a, x / 2),   P(X > x) = Q(a, x / 2),
///
/// by the power series of P below x / 2 = a + 1 and Lentz' continued fraction
/// of Q above (Press et al. 2007, "Numerical Recipes", 3rd ed., section 6.2),
/// with Loader's saddle-point form of their common factor (Loader 2000, "Fast
/// and Accurate Computation of Binomial Probabilities").
///
/// Relative errors stay below 1e-12 for 0.1 <= dof <= 1e4, in both tails down
/// to 1e-300, and grow beyond, where the rounding of x tells. So ask for the
/// survival of a large x and not for 1 - ChiSquareCdf. No state; O(sqrt(dof)).
/// @pre dof > 0, finite.

/// P(X <= x); 0 for x <= 0.
double ChiSquareCdf(double x, double dof);

/// P(X > x) = 1 - ChiSquareCdf, without the loss of digits; 1 for x <= 0.
double ChiSquareSurvival(double x, double dof);

/// x with ChiSquareCdf(x, dof) = probability, by Newton's method on the
/// logarithms of both, kept in a bracket; 0 at 0 and infinity at 1.
/// @pre 0 <= probability <= 1.
double ChiSquareQuantile(double probability, double dof);

/// x with ChiSquareSurvival(x, dof) = survival: the bound that X exceeds with
/// probability `survival`, which may be as small as 1e-300; infinity at 0 and
/// 0 at 1. @pre 0 <= survival <= 1.
double ChiSquareUpperQuantile(double survival, double dof);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_COMMON_CHI_SQUARE_H_
