#include "alidade/accuracy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "alidade/shared_matrix.h"

namespace alidade {
namespace {

// What SortedPercentile is of the same values in order; changes their order.
double Percentile(double fraction, VectorBuilder::Map values) {
  double* const first = values.data();
  double* const end = first + values.size();
  const double position = fraction * static_cast<double>(values.size() - 1);
  double* const below = first + static_cast<std::ptrdiff_t>(position);
  std::nth_element(first, below, end);
  const double weight = position - static_cast<double>(below - first);
  const double above =
      below + 1 < end ? *std::min_element(below + 1, end) : *below;
  return (1.0 - weight) * *below + weight * above;
}

}  // namespace

double SortedPercentile(const Eigen::VectorXd& sorted, double fraction) {
  const double position = fraction * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<Eigen::Index>(position);
  const Eigen::Index above = std::min(below + 1, sorted.size() - 1);
  const double weight = position - static_cast<double>(below);
  return (1.0 - weight) * sorted[below] + weight * sorted[above];
}

Accuracy SummarizeErrors(const Eigen::Ref<const Eigen::VectorXd>& errors) {
  Accuracy accuracy;
  accuracy.n = errors.size();
  if (errors.size() == 0) return accuracy;
  const auto n = static_cast<double>(errors.size());
  accuracy.mean = errors.mean();
  accuracy.rms = errors.norm() / std::sqrt(n);
  if (errors.size() > 1) {
    accuracy.stddev =
        (errors.array() - accuracy.mean).matrix().norm() / std::sqrt(n - 1.0);
  }
  VectorBuilder selected(errors);
  accuracy.median = Percentile(0.5, selected.map());
  accuracy.p95 = Percentile(0.95, selected.map());
  accuracy.min = errors.minCoeff();
  accuracy.max = errors.maxCoeff();
  return accuracy;
}

}  // namespace alidade
