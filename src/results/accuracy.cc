#include "alidade/results/accuracy.h"

#include <algorithm>
#include <cmath>

namespace alidade {
double SortedPercentile(const Eigen::VectorXd& sorted, double fraction) {
  const double position = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<Eigen::Index>(position);
  const Eigen::Index above = std::min(below + 1, sorted.size() - 1);
  const double weight = position - static_cast<double>(below);
  return (1.0 - weight) * sorted[below] + weight * sorted[above];
}

Accuracy SummarizeErrors(const Eigen::VectorXd& errors) {
  Accuracy accuracy;
  accuracy.n = errors.size();
  if (errors.size() == 0) return accuracy;
  Eigen::VectorXd sorted = errors;
  std::sort(sorted.data(), sorted.data() + sorted.size());
  const auto n = static_cast<double>(errors.size());
  accuracy.mean = errors.mean();
  accuracy.rms = errors.norm() / std::sqrt(n);
  if (errors.size() > 1) {
    accuracy.stddev =
        (errors.array() - accuracy.mean).matrix().norm() / std::sqrt(n - 1.0);
  }
  accuracy.median = SortedPercentile(sorted, 0.5);
  accuracy.p95 = SortedPercentile(sorted, 0.95);
  accuracy.min = sorted[0];
  accuracy.max = sorted[sorted.size() - 1];
  return accuracy;
}

}  // namespace alidade
