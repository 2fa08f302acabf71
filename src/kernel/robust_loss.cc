#include "alidade/robust_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "src/common/distributions.h"

namespace alidade {

using internal::ChiSquareQuantile;
using internal::ChiSquareUpperQuantile;

namespace {

constexpr double kEfficiency = 0.95;
// Of the chi density left out at either end of the integrals.
constexpr double kNeglected = 1e-18;
constexpr int kPanels = 64;

// Sums over the density of |r|, not normalised.
struct Moments {
  double one = 0.0;
  double slope = 0.0;      // w + |r| w' / d
  double influence = 0.0;  // w^2 |r|^2
};

// Adds one panel by the Gauss-Legendre rule of five points.
template <typename Integrand>
void AddPanel(double from, double to, const Integrand& add) {
  const double middle = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  const double ratio = 2.0 * std::sqrt(10.0 / 7.0);
  const double inner = half * std::sqrt(5.0 - ratio) / 3.0;
  const double outer = half * std::sqrt(5.0 + ratio) / 3.0;
  const double inner_share = half * (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
  const double outer_share = half * (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
  add(middle, half * 128.0 / 225.0);
  add(middle - inner, inner_share);
  add(middle + inner, inner_share);
  add(middle - outer, outer_share);
  add(middle + outer, outer_share);
}

double Efficiency(const RobustLoss& loss, int dimension) {
  const double d = dimension;
  const double mode = std::sqrt(std::max(d - 1.0, 1.0));
  Moments moments;
  const auto add = [&](double r, double share) {
    double rho[3];
    loss.Evaluate(r * r, rho);
    // Over the density at its mode, which may be out of range itself.
    const double density = std::exp((d - 1.0) * std::log(r / mode) -
                                    0.5 * (r - mode) * (r + mode));
    const double weight_by_r = 2.0 * r * rho[2];
    moments.one += share * density;
    moments.slope += share * density * (rho[1] + r * weight_by_r / d);
    moments.influence += share * density * rho[1] * rho[1] * r * r;
  };
  const double from = std::sqrt(ChiSquareQuantile(kNeglected, d));
  const double to = std::sqrt(ChiSquareUpperQuantile(kNeglected, d));
  // The weight has a kink at c: no panel may lie across.
  const double kink = std::clamp(loss.tuning_constant, from, to);
  for (int k = 0; k < kPanels; ++k) {
    const double left = static_cast<double>(k) / kPanels;
    const double right = static_cast<double>(k + 1) / kPanels;
    AddPanel(from + left * (kink - from), from + right * (kink - from), add);
    AddPanel(kink + left * (to - kink), kink + right * (to - kink), add);
  }
  return d * moments.slope * moments.slope / (moments.one * moments.influence);
}

}  // namespace

void RobustLoss::Evaluate(double s, double rho[3]) const {
  const double c = tuning_constant;
  const double u = s / (c * c);
  rho[0] = s;
  rho[1] = 1.0;
  rho[2] = 0.0;
  if (kind == LossKind::kHuber && u > 1.0) {
    const double norm = std::sqrt(s);
    rho[0] = c * (2.0 * norm - c);
    rho[1] = c / norm;
    rho[2] = -0.5 * rho[1] / s;
  } else if (kind == LossKind::kCauchy) {
    rho[0] = c * c * std::log1p(u);
    rho[1] = 1.0 / (1.0 + u);
    rho[2] = -rho[1] * rho[1] / (c * c);
  } else if (kind == LossKind::kTukey && u > 1.0) {
    rho[0] = c * c / 3.0;
    rho[1] = 0.0;
  } else if (kind == LossKind::kTukey) {
    // Expanded: a difference of cubes near 1 loses the digits of small s.
    rho[0] = s * (1.0 - u * (1.0 - u / 3.0));
    rho[1] = (1.0 - u) * (1.0 - u);
    rho[2] = -2.0 * (1.0 - u) / (c * c);
  }
}

double RobustLoss::Weight(double s) const {
  double rho[3];
  Evaluate(s, rho);
  return rho[1];
}

double TuningConstant(LossKind kind, int dimension) {
  if (kind == LossKind::kNone) return std::numeric_limits<double>::infinity();
  double low = 0.1 * MedianOfChi(dimension);
  // Negated, for the 0 / 0 of a loss that is flat where the density is not 0.
  const auto is_too_low = [&](double c) {
    return !(Efficiency({kind, c}, dimension) >= kEfficiency);
  };
  if (!is_too_low(low)) return low;
  double high = 2.0 * low;
  while (is_too_low(high)) high *= 2.0;
  for (int iteration = 0; iteration < 40; ++iteration) {
    const double middle = 0.5 * (low + high);
    (is_too_low(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

namespace {

// Rows that an observation has at most.
constexpr int kMostRows = 6;

std::vector<RobustLoss> Tune(LossKind kind) {
  std::vector<RobustLoss> losses;
  for (int dimension = 1; dimension <= kMostRows; ++dimension) {
    losses.push_back({kind, TuningConstant(kind, dimension)});
  }
  return losses;
}

double ComputeMedianOfChi(int dimension) {
  return std::sqrt(ChiSquareQuantile(0.5, dimension));
}

}  // namespace

std::vector<RobustLoss> TunedLosses(LossKind kind) {
  // Never destroyed, as statics should be.
  static const auto* const huber =
      new std::vector<RobustLoss>(Tune(LossKind::kHuber));
  static const auto* const cauchy =
      new std::vector<RobustLoss>(Tune(LossKind::kCauchy));
  static const auto* const tukey =
      new std::vector<RobustLoss>(Tune(LossKind::kTukey));
  switch (kind) {
    case LossKind::kNone:
      break;
    case LossKind::kHuber:
      return *huber;
    case LossKind::kCauchy:
      return *cauchy;
    case LossKind::kTukey:
      return *tukey;
  }
  return {};
}

double MedianOfChi(int dimension) {
  // Asked for once an observation.
  static const std::array<double, kMostRows> medians = [] {
    std::array<double, kMostRows> values{};
    for (int d = 1; d <= kMostRows; ++d) values[d - 1] = ComputeMedianOfChi(d);
    return values;
  }();
  return dimension <= kMostRows ? medians[dimension - 1]
                                : ComputeMedianOfChi(dimension);
}

double RobustScale(std::vector<double> norms, int dimension) {
  if (norms.empty()) return 0.0;
  const auto middle =
      norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2);
  std::nth_element(norms.begin(), middle, norms.end());
  double median = *middle;
  if (norms.size() % 2 == 0) {
    median = 0.5 * (median + *std::max_element(norms.begin(), middle));
  }
  return median / MedianOfChi(dimension);
}

}  // namespace alidade
