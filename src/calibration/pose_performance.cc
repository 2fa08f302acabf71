#include "src/calibration/pose_performance.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/calibration/outliers.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostGrouped = 200'000;
constexpr std::size_t kMostListed = 1000;
constexpr std::ptrdiff_t kFewestRepeats = 3;

// Observations of one target at one configuration.
using Repeats = std::vector<Eigen::Index>;

bool IsWholePosition(const EvaluatedSet& set, Eigen::Index i) {
  if (set.labels.empty()) return true;
  const ObservationLabel& label = set.labels[i];
  return (label.kind == "position" || label.kind == "pose") &&
         set.positions.col(i).allFinite();
}

int PoseOf(const EvaluatedSet& set, Eigen::Index i) {
  return set.labels.empty() ? static_cast<int>(i) : set.labels[i].pose;
}

// Below zero, zero or above: as joint values and target of `a` come before,
// equal or come after those of `b`.
int Compare(const EvaluatedSet& set, Eigen::Index a, Eigen::Index b) {
  for (Eigen::Index j = 0; j < set.joint_values.rows(); ++j) {
    const double of_a = set.joint_values(j, PoseOf(set, a));
    const double of_b = set.joint_values(j, PoseOf(set, b));
    if (of_a != of_b) return of_a < of_b ? -1 : 1;
  }
  return set.labels.empty()
             ? 0
             : set.labels[a].target.compare(set.labels[b].target);
}

// Those of enough, in the order of their first observations.
std::vector<Repeats> FindRepeats(const EvaluatedSet& set,
                                 const std::vector<Outlier>& outliers) {
  const std::vector<Eigen::Index> rejected = RejectedObservations(outliers);
  std::vector<Eigen::Index> sorted;
  for (Eigen::Index i = 0; i < set.residual_after.cols(); ++i) {
    if (IsWholePosition(set, i) &&
        !std::binary_search(rejected.begin(), rejected.end(), i)) {
      sorted.push_back(i);
    }
  }
  std::sort(sorted.begin(), sorted.end(), [&](Eigen::Index a, Eigen::Index b) {
    const int order = Compare(set, a, b);
    return order != 0 ? order < 0 : a < b;
  });
  std::vector<Repeats> repeats;
  for (auto first = sorted.begin(); first != sorted.end();) {
    const auto end = std::find_if(first, sorted.end(), [&](Eigen::Index i) {
      return Compare(set, *first, i) != 0;
    });
    if (end - first >= kFewestRepeats) repeats.emplace_back(first, end);
    first = end;
  }
  std::sort(repeats.begin(), repeats.end());
  return repeats;
}

// Columns of residuals, predicted less measured, as attained less commanded.
Eigen::Matrix3Xd Attained(const SharedMatrix& residuals,
                          const Repeats& repeats) {
  Eigen::Matrix3Xd attained(3, static_cast<Eigen::Index>(repeats.size()));
  for (Eigen::Index k = 0; k < attained.cols(); ++k) {
    attained.col(k) = -residuals.col(repeats[k]);
  }
  return attained;
}

bool HaveRotations(const EvaluatedSet& set, const Repeats& repeats) {
  return set.rotation_residual_after.cols() > 0 &&
         std::all_of(repeats.begin(), repeats.end(), [&](Eigen::Index i) {
           return set.labels[i].has_rotation;
         });
}

PosePerformance Measure(const EvaluatedSet& set, const Repeats& repeats) {
  PosePerformance one;
  one.pose = PoseOf(set, repeats.front());
  if (!set.labels.empty()) one.target = set.labels[repeats.front()].target;
  one.n = static_cast<std::int64_t>(repeats.size());
  const auto free = static_cast<double>(one.n - 1);
  one.before = Attained(set.residual_before, repeats).rowwise().mean().norm();
  const Eigen::Matrix3Xd attained = Attained(set.residual_after, repeats);
  const Eigen::Vector3d barycentre = attained.rowwise().mean();
  one.accuracy = barycentre.norm();
  const Eigen::ArrayXd distances =
      (attained.colwise() - barycentre).colwise().norm().transpose();
  one.mean_distance = distances.mean();
  one.distance_std =
      std::sqrt((distances - one.mean_distance).square().sum() / free);
  if (HaveRotations(set, repeats)) {
    const Eigen::Matrix3Xd turns =
        Attained(set.rotation_residual_after, repeats);
    one.rotation_accuracy = turns.rowwise().mean();
    one.rotation_repeatability =
        3.0 * ((turns.colwise() - one.rotation_accuracy).rowwise().norm() /
               std::sqrt(free));
  }
  return one;
}

}  // namespace

std::optional<PosePerformanceSummary> MeasurePosePerformance(
    const std::string& poses, const EvaluatedSet& set,
    const std::vector<Outlier>& outliers) {
  if (set.residual_after.cols() > kMostGrouped) return std::nullopt;
  std::vector<PosePerformance> all;
  for (const Repeats& repeats : FindRepeats(set, outliers)) {
    all.push_back(Measure(set, repeats));
  }
  if (all.empty()) return std::nullopt;
  PosePerformanceSummary summary;
  summary.poses = poses;
  summary.configurations = static_cast<std::int64_t>(all.size());
  summary.fewest =
      std::min_element(all.begin(), all.end(),
                       [](const auto& a, const auto& b) { return a.n < b.n; })
          ->n;
  const auto summarize = [&all](const auto& quantity) {
    Eigen::VectorXd values(static_cast<Eigen::Index>(all.size()));
    std::transform(all.begin(), all.end(), values.begin(), quantity);
    return SummarizeErrors(values);
  };
  summary.before =
      summarize([](const PosePerformance& one) { return one.before; });
  summary.accuracy =
      summarize([](const PosePerformance& one) { return one.accuracy; });
  summary.repeatability =
      summarize([](const PosePerformance& one) { return one.repeatability(); });
  if (all.size() > kMostListed) all.resize(kMostListed);
  summary.each = std::move(all);
  return summary;
}

}  // namespace alidade::internal
