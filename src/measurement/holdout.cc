#include "alidade/measurement/holdout.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "alidade/base/random.h"

namespace alidade {
namespace {

// The configurations 0 .. count - 1 in an order drawn by the seed (Fisher and
// Yates).
std::vector<int> Shuffled(int count, std::uint64_t seed) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  Random random(seed, 0);
  for (int i = count - 1; i > 0; --i) {
    const double draw = random.Uniform(0.0, static_cast<double>(i + 1));
    std::swap(order[i], order[std::min(i, static_cast<int>(draw))]);
  }
  return order;
}

int CountGroups(const std::vector<int>& groups) {
  return groups.empty() ? 0
                        : 1 + *std::max_element(groups.begin(), groups.end());
}

HoldOut Split(const Dataset& data, const std::vector<int>& groups,
              const std::vector<char>& is_heldout) {
  std::vector<Eigen::Index> train;
  std::vector<Eigen::Index> heldout;
  for (std::size_t row = 0; row < groups.size(); ++row) {
    (is_heldout[groups[row]] != 0 ? heldout : train)
        .push_back(static_cast<Eigen::Index>(row));
  }
  return {SelectRows(data, train), SelectRows(data, heldout)};
}

}  // namespace

std::vector<int> GroupByConfiguration(const Dataset& data) {
  const auto less = [&](Eigen::Index a, Eigen::Index b) {
    const auto x = data.joint_values.col(a);
    const auto y = data.joint_values.col(b);
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      if (x[j] != y[j]) return x[j] < y[j];
    }
    return false;
  };
  std::vector<Eigen::Index> order(data.num_poses());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), less);
  // The first row of each configuration stands for it.
  std::vector<Eigen::Index> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new = i == 0 || less(order[i - 1], order[i]);
    first[order[i]] = is_new ? order[i] : first[order[i - 1]];
  }
  std::vector<int> groups(order.size());
  int count = 0;
  for (std::size_t row = 0; row < groups.size(); ++row) {
    const bool is_first = first[row] == static_cast<Eigen::Index>(row);
    groups[row] = is_first ? count++ : groups[first[row]];
  }
  return groups;
}

Dataset SelectRows(const Dataset& data, const std::vector<Eigen::Index>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Dataset selected;
  selected.name = data.name;
  selected.joint_values.resize(data.num_joints(), count);
  selected.positions.resize(3, count);
  selected.sigmas.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    selected.joint_values.col(i) = data.joint_values.col(rows[i]);
    selected.positions.col(i) = data.positions.col(rows[i]);
    selected.sigmas.col(i) = data.sigmas.col(rows[i]);
  }
  return selected;
}

HoldOut HoldOutFraction(const Dataset& data, double fraction,
                        std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  const int count = CountGroups(groups);
  const auto num_heldout = static_cast<int>(std::lround(fraction * count));
  const std::vector<int> order = Shuffled(count, seed);
  std::vector<char> is_heldout(count, 0);
  for (int i = 0; i < num_heldout; ++i) is_heldout[order[i]] = 1;
  return Split(data, groups, is_heldout);
}

HoldOut HoldOutFold(const Dataset& data, int folds, int k, std::uint64_t seed) {
  const std::vector<int> groups = GroupByConfiguration(data);
  const int count = CountGroups(groups);
  const std::vector<int> order = Shuffled(count, seed);
  std::vector<char> is_heldout(count, 0);
  for (int i = k; i < count; i += folds) is_heldout[order[i]] = 1;
  return Split(data, groups, is_heldout);
}

}  // namespace alidade
