#include "src/common/chi_square.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/units.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Never reached for dof up to 1e10; ends the loops on arguments not numbers.
constexpr int kMaxTerms = 10000000;

enum class Tail { kLower, kUpper };

// log of gamma(a + 1) over Stirling's formula; the first term left out is
// below 1e-16 for a >= 16.
double StirlingError(double a) {
  const double b = 1.0 / (a * a);
  return (1.0 / 12.0 -
          b * (1.0 / 360.0 -
               b * (1.0 / 1260.0 - b * (1.0 / 1680.0 - b / 1188.0)))) /
         a;
}

// a log(a / x) + x - a, not negative, without cancellation where x is near a.
double Deviance(double a, double x) {
  const double v = (a - x) / (a + x);
  if (std::abs(v) > 0.1) return a * std::log(a / x) + x - a;
  double sum = (a - x) * v;
  double term = 2.0 * a * v;
  for (int j = 1; j < 20; ++j) {
    term *= v * v;
    sum += term / (2 * j + 1);
  }
  return sum;
}

// x^a exp(-x) / gamma(a + 1).
double PoissonFactor(double a, double x) {
  if (a < 16.0) return std::exp(a * std::log(x) - x) / std::tgamma(a + 1.0);
  return std::exp(-Deviance(a, x) - StirlingError(a)) /
         std::sqrt(2.0 * kPi * a);
}

// P over the factor, for x < a + 1.
double LowerSeries(double a, double x) {
  double sum = 1.0;
  double term = 1.0;
  for (int k = 1; k < kMaxTerms && term > 0.1 * kEpsilon * sum; ++k) {
    term *= x / (a + k);
    sum += term;
  }
  return sum;
}

// Q over the factor, for x >= a + 1, where every denominator is positive.
double UpperFraction(double a, double x) {
  double b = x + 1.0 - a;
  double c = kInfinity;
  double d = 1.0 / b;
  double fraction = d;
  for (int k = 1; k < kMaxTerms; ++k) {
    const double numerator = k * (a - k);
    b += 2.0;
    d = 1.0 / (b + numerator * d);
    c = b + numerator / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < kEpsilon) break;
  }
  return a * fraction;
}

double Probability(Tail tail, double x, double dof) {
  if (x <= 0.0) return tail == Tail::kLower ? 0.0 : 1.0;
  if (x == kInfinity) return tail == Tail::kLower ? 1.0 : 0.0;
  const double a = 0.5 * dof;
  const double y = 0.5 * x;
  const bool is_lower = y < a + 1.0;
  const double probability =
      PoissonFactor(a, y) *
      (is_lower ? LowerSeries(a, y) : UpperFraction(a, y));
  return is_lower == (tail == Tail::kLower) ? probability : 1.0 - probability;
}

// Wilson and Hilferty 1931: the cube root of x / dof is nearly normal. The
// normal quantile is a crude one: Newton's method mends it.
double FirstGuess(Tail tail, double probability, double dof) {
  const double z = std::sqrt(std::max(0.0, -2.0 * std::log(2.0 * probability)));
  const double variance = 2.0 / (9.0 * dof);
  const double root =
      1.0 - variance + (tail == Tail::kLower ? -z : z) * std::sqrt(variance);
  if (root > 0.1) return dof * root * root * root;
  // Far in the lower tail P is close to the factor.
  const double a = 0.5 * dof;
  const double log_gamma =
      a < 16.0 ? std::log(std::tgamma(a + 1.0))
               : a * (std::log(a) - 1.0) + 0.5 * std::log(2.0 * kPi * a);
  return 2.0 * std::exp((std::log(probability) + log_gamma) / a);
}

// Both log P and log Q are smooth in log x, and log P is nearly straight, so
// that Newton's steps are taken there. Only for the smaller tail.
double Solve(Tail tail, double probability, double dof) {
  double low = 0.0;
  double high = kInfinity;
  double x = FirstGuess(tail, probability, dof);
  for (int iteration = 0; iteration < 200 && x > 0.0; ++iteration) {
    const double value = Probability(tail, x, dof);
    const bool is_low = (value < probability) == (tail == Tail::kLower);
    (is_low ? low : high) = x;
    const double slope = 0.5 * dof * PoissonFactor(0.5 * dof, 0.5 * x) / value;
    double step = std::log(value / probability) / slope;
    if (tail == Tail::kLower) step = -step;
    double next = x * std::exp(step);
    // Also taken where the value underflows and the step is no number.
    if (!(next >= low && next <= high) || next == 0.0 || next == kInfinity) {
      next = low == 0.0          ? 0.25 * high
             : high == kInfinity ? 4.0 * low
                                 : std::sqrt(low) * std::sqrt(high);
      step = 1.0;
    }
    if (next == x) return x;
    x = next;
    // Newton's method squares the error: the next step would not be seen.
    if (std::abs(step) < 1e-10) return x;
  }
  return x;
}

}  // namespace

double ChiSquareCdf(double x, double dof) {
  return Probability(Tail::kLower, x, dof);
}

double ChiSquareSurvival(double x, double dof) {
  return Probability(Tail::kUpper, x, dof);
}

double ChiSquareQuantile(double probability, double dof) {
  if (probability <= 0.0) return 0.0;
  if (probability >= 1.0) return kInfinity;
  // The difference is exact.
  if (probability > 0.5) return Solve(Tail::kUpper, 1.0 - probability, dof);
  return Solve(Tail::kLower, probability, dof);
}

double ChiSquareUpperQuantile(double survival, double dof) {
  if (survival <= 0.0) return kInfinity;
  if (survival >= 1.0) return 0.0;
  if (survival > 0.5) return Solve(Tail::kLower, 1.0 - survival, dof);
  return Solve(Tail::kUpper, survival, dof);
}

}  // namespace alidade::internal
