#include "src/error_terms/stacking.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace alidade::internal {
namespace {

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Rungs x rungs: products of weighted residuals.
Eigen::MatrixXd ProductsOf(const FoldErrors& fold) {
  std::vector<double> smallest;
  for (const Eigen::MatrixXd& residual : fold.residuals) {
    smallest.push_back(residual.colwise().norm().minCoeff());
  }
  const double median = Median(smallest);
  const Eigen::Index rungs = fold.residuals.front().cols();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(rungs, rungs);
  for (std::size_t k = 0; k < smallest.size(); ++k) {
    const double weight = smallest[k] > median ? median / smallest[k] : 1.0;
    products += weight * fold.residuals[k].transpose() * fold.residuals[k];
  }
  return products;
}

// min w^T M w, w >= 0, sum w = 1: of a handful of rungs every set of those with
// a part is looked at.
Eigen::VectorXd Weights(const Eigen::MatrixXd& products) {
  const auto rungs = static_cast<int>(products.cols());
  constexpr double kWorthwhile = 2e-3;
  const double little = 1e-12 * products.trace();
  Eigen::VectorXd best = Eigen::VectorXd::Unit(rungs, 0);
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < (1U << static_cast<unsigned>(rungs)); ++set) {
    std::vector<int> in;
    for (int k = 0; k < rungs; ++k) {
      if ((set >> static_cast<unsigned>(k)) & 1U) in.push_back(k);
    }
    Eigen::MatrixXd matrix = products(in, in);
    matrix.diagonal().array() += little;
    Eigen::VectorXd weights = matrix.fullPivLu().solve(
        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(in.size())));
    if (weights.minCoeff() < 0.0 || !weights.allFinite()) continue;
    weights /= weights.sum();
    const double value = weights.dot(matrix * weights);
    // Of sets as good as others the first is taken, with the fewest terms.
    if (!(value < (1.0 - kWorthwhile) * least)) continue;
    least = value;
    best.setZero();
    for (std::size_t k = 0; k < in.size(); ++k) {
      best[in[k]] = weights[static_cast<Eigen::Index>(k)];
    }
  }
  return best;
}

// Mean error of each pose, with these weights of the rungs.
std::map<int, double> PoseErrors(const FoldErrors& fold,
                                 const Eigen::VectorXd& weights) {
  std::map<int, std::pair<double, int>> sums;
  for (std::size_t k = 0; k < fold.residuals.size(); ++k) {
    auto& [sum, count] = sums[fold.poses[k]];
    sum += (fold.residuals[k] * weights).norm();
    ++count;
  }
  std::map<int, double> errors;
  for (const auto& [pose, sum] : sums) {
    errors[pose] = sum.first / sum.second;
  }
  return errors;
}

double MeanOf(const std::map<int, double>& errors) {
  double sum = 0.0;
  for (const auto& [pose, error] : errors) sum += error;
  return sum / static_cast<double>(errors.size());
}

// Mean error of the observations of all folds of a kind, each with its weights.
double MeanError(const std::vector<FoldErrors>& folds, bool of_regions,
                 const std::vector<Eigen::VectorXd>& weights) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    if (folds[k].is_region != of_regions) continue;
    for (const Eigen::MatrixXd& residual : folds[k].residuals) {
      sum += (residual * weights[k]).norm();
      count += 1.0;
    }
  }
  return sum / std::max(1.0, count);
}

// The mean over its standard error.
double TOfMean(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const Eigen::Map<const Eigen::ArrayXd> all(
      values.data(), static_cast<Eigen::Index>(values.size()));
  const double mean = all.mean();
  const auto count = static_cast<double>(values.size());
  const double variance = (all - mean).square().sum() / (count - 1.0);
  return mean /
         (std::sqrt(variance / count) + std::numeric_limits<double>::min());
}

}  // namespace

StackingResult Stack(const std::vector<FoldErrors>& folds) {
  constexpr double kClip = 4.0;
  constexpr double kEvidence = 2.0;
  constexpr double kDegree = 3.0;
  StackingResult result;
  std::vector<Eigen::MatrixXd> products;
  for (const FoldErrors& fold : folds) products.push_back(ProductsOf(fold));
  Eigen::MatrixXd total = products.front();
  for (std::size_t k = 1; k < products.size(); ++k) total += products[k];
  result.weights = Weights(total);
  const Eigen::VectorXd geometry =
      Eigen::VectorXd::Unit(result.weights.size(), 0);
  std::vector<double> log_gains;
  std::vector<double> gains;
  std::vector<Eigen::VectorXd> delivered;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    const Eigen::VectorXd weights = Weights(total - products[k]);
    delivered.push_back(weights);
    const std::map<int, double> before = PoseErrors(folds[k], geometry);
    const std::map<int, double> after = PoseErrors(folds[k], weights);
    if (folds[k].is_region) {
      log_gains.push_back(std::log(MeanOf(before) / MeanOf(after)));
      continue;
    }
    for (const auto& [pose, error] : before) {
      gains.push_back(error - after.at(pose));
    }
  }
  std::vector<double> sizes;
  for (const double gain : gains) sizes.push_back(std::abs(gain));
  const double limit = kClip * Median(sizes);
  for (double& gain : gains) gain = std::clamp(gain, -limit, limit);
  result.t_regions = TOfMean(log_gains);
  result.t_random = TOfMean(gains);
  const double t = std::min(result.t_regions, result.t_random);
  if (t > kEvidence) {
    result.share = 1.0 - std::pow(kEvidence / t, kDegree);
  }
  for (Eigen::VectorXd& weights : delivered) {
    weights = geometry + result.share * (weights - geometry);
  }
  result.region_error = MeanError(folds, true, delivered);
  result.random_error = MeanError(folds, false, delivered);
  return result;
}

}  // namespace alidade::internal
