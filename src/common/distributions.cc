#include "src/common/distributions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alidade/units.h"
#include "src/common/chi_square.h"

namespace alidade::internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Degrees of freedom from which on a distribution is its limit.
constexpr double kAsGoodAsInfinite = 1e8;

// std::lgamma writes a global, which threads must not.
double LogGamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

// Density of a beta variable.
double BetaDensity(double x, double a, double b) {
  return std::exp(LogGamma(a + b) - LogGamma(a) - LogGamma(b) +
                  (a - 1.0) * std::log(x) + (b - 1.0) * std::log1p(-x));
}

// Converges fast for x < (a + 1) / (a + b + 2).
double BetaFraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  constexpr int kMaxTerms = 100000;
  const auto away_from_zero = [](double value) {
    return std::abs(value) < kTiny ? kTiny : value;
  };
  double c = 1.0;
  double d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
  double fraction = d;
  for (int m = 1; m < kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
    d = 1.0 / away_from_zero(1.0 + even * d);
    c = away_from_zero(1.0 + even / c);
    fraction *= c * d;
    const double odd =
        -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
    d = 1.0 / away_from_zero(1.0 + odd * d);
    c = away_from_zero(1.0 + odd / c);
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < kEpsilon) break;
  }
  return fraction;
}

// x and 1 - x with P(X <= x) = probability, whichever is exact.
struct BetaPoint {
  double x = 0.0;
  double rest = 0.0;
};

// Bisection narrows, Newton's steps finish.
double SolveBeta(double probability, double a, double b) {
  double low = 0.0;
  double high = 1.0;
  double x = a / (a + b);
  for (int iteration = 0; iteration < 400; ++iteration) {
    const double value = BetaCdf(x, a, b);
    (value < probability ? low : high) = x;
    const double step = (value - probability) / BetaDensity(x, a, b);
    double next = x - step;
    if (!(next > low && next < high)) {
      // In the logarithm, since quantiles may be as small as 1e-300.
      next = low > 0.0 && high > 4.0 * low ? std::sqrt(low * high)
             : low == 0.0                  ? 0.25 * high
                                           : 0.5 * (low + high);
    }
    if (std::abs(next - x) <= kEpsilon * x) return next;
    x = next;
  }
  return x;
}

BetaPoint BetaQuantilePoint(double probability, double a, double b) {
  if (probability <= 0.0) return {0.0, 1.0};
  if (probability >= 1.0) return {1.0, 0.0};
  if (probability <= BetaCdf(a / (a + b), a, b)) {
    const double x = SolveBeta(probability, a, b);
    return {x, 1.0 - x};
  }
  const double rest = SolveBeta(1.0 - probability, b, a);
  return {1.0 - rest, rest};
}

}  // namespace

double NormalCdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

double NormalQuantile(double probability) {
  if (probability <= 0.0) return -kInfinity;
  if (probability >= 1.0) return kInfinity;
  if (probability > 0.5) return -NormalQuantile(1.0 - probability);
  // Abramowitz and Stegun 26.2.23 starts within 5e-4.
  const double t = std::sqrt(-2.0 * std::log(probability));
  double z = -(t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                       (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))));
  for (int iteration = 0; iteration < 4; ++iteration) {
    const double value = NormalCdf(z);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * kPi);
    z -= std::log(value / probability) * value / density;
  }
  return z;
}

double BetaCdf(double x, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front = std::exp(LogGamma(a + b) - LogGamma(a) - LogGamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * BetaFraction(x, a, b) / a;
  return 1.0 - front * BetaFraction(1.0 - x, b, a) / b;
}

double BetaQuantile(double probability, double a, double b) {
  return BetaQuantilePoint(probability, a, b).x;
}

double StudentTQuantile(double probability, double dof) {
  if (probability < 0.5) return -StudentTQuantile(1.0 - probability, dof);
  if (!(dof < kAsGoodAsInfinite)) return NormalQuantile(probability);
  // T^2 is F of 1 and dof.
  return std::sqrt(FisherQuantile(2.0 * probability - 1.0, 1.0, dof));
}

double FisherQuantile(double probability, double dof1, double dof2) {
  if (!(dof2 < kAsGoodAsInfinite)) {
    return ChiSquareQuantile(probability, dof1) / dof1;
  }
  const BetaPoint point =
      BetaQuantilePoint(probability, 0.5 * dof1, 0.5 * dof2);
  return dof2 * point.x / (dof1 * point.rest);
}

std::pair<double, double> RateInterval(std::int64_t held, std::int64_t n,
                                       double confidence) {
  if (n == 0) return {0.0, 1.0};
  const double tail = 0.5 * (1.0 - confidence);
  const auto k = static_cast<double>(held);
  const auto rest = static_cast<double>(n - held);
  return {held == 0 ? 0.0 : BetaQuantile(tail, k, rest + 1.0),
          held == n ? 1.0 : BetaQuantile(1.0 - tail, k + 1.0, rest)};
}

}  // namespace alidade::internal
