#include "src/calibration/outlier_pattern.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "alidade/error_terms.h"
#include "src/common/distributions.h"

namespace alidade::internal {
namespace {

// Mean ranks of ties, from 1.
std::vector<double> RanksOf(const std::vector<double>& values) {
  std::vector<int> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() &&
           values[order[last + 1]] == values[order[first]]) {
      ++last;
    }
    for (std::size_t k = first; k <= last; ++k) {
      ranks[order[k]] = 1.0 + 0.5 * static_cast<double>(first + last);
    }
    first = last + 1;
  }
  return ranks;
}

// The rank sum of those that are in, in standard deviations.
double RankSumZ(const std::vector<double>& values,
                const std::vector<bool>& is_in) {
  const std::vector<double> ranks = RanksOf(values);
  double sum = 0.0;
  double in = 0.0;
  for (std::size_t k = 0; k < ranks.size(); ++k) {
    if (!is_in[k]) continue;
    sum += ranks[k];
    in += 1.0;
  }
  const auto all = static_cast<double>(ranks.size());
  const double variance = in * (all - in) * (all + 1.0) / 12.0;
  return variance > 0.0 ? (sum - 0.5 * in * (all + 1.0)) / std::sqrt(variance)
                        : 0.0;
}

}  // namespace

std::string PatternOf(const Arm& arm, const Dataset& data,
                      const std::vector<Outlier>& outliers) {
  constexpr int kFewest = 5;
  constexpr double kUnlikely = 1e-4;
  constexpr double kRejected = 0.5;
  std::vector<bool> is_in(static_cast<std::size_t>(data.num_poses()), false);
  for (const Outlier& outlier : outliers) {
    const int pose = outlier.label.pose;
    if (outlier.weight < kRejected && pose >= 0 && pose < data.num_poses()) {
      is_in[static_cast<std::size_t>(pose)] = true;
    }
  }
  if (std::count(is_in.begin(), is_in.end(), true) < kFewest) return "";
  const int n = arm.num_joints();
  Eigen::MatrixXd features(2 * n, data.num_poses());
  for (Eigen::Index pose = 0; pose < data.num_poses(); ++pose) {
    const Eigen::VectorXd q = data.joint_values.col(pose);
    features.col(pose) << q,
        LoadMoments(arm, q.data()).row(2).transpose().cwiseAbs();
  }
  double largest = 0.0;
  std::string pattern;
  for (int k = 0; k < 2 * n; ++k) {
    const Eigen::VectorXd row = features.row(k);
    const double z =
        std::abs(RankSumZ({row.data(), row.data() + row.size()}, is_in));
    if (z <= largest) continue;
    largest = z;
    pattern = (k < n ? "the value of joint " : "the gravity moment of joint ") +
              std::to_string(k % n + 1);
  }
  const double chance = 2.0 * 2.0 * n * NormalCdf(-largest);
  return chance < kUnlikely ? pattern : "";
}

}  // namespace alidade::internal
