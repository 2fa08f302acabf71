#include "src/error_terms/folds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/common/random.h"
#include "src/kernel/holdout.h"

namespace alidade::internal {
namespace {

// Seeds of the folds within training data, which have no other reason.
constexpr std::uint64_t kFirstRegionSeed = 1000;
constexpr std::uint64_t kRandomSeed = 5;
constexpr double kRegionFraction = 0.25;

// One column per configuration, scaled, and the configuration of each pose.
struct Configurations {
  std::vector<int> of_pose;
  Eigen::MatrixXd scaled;  // n x configurations

  Eigen::Index size() const { return scaled.cols(); }
  std::vector<bool> Poses(const std::vector<bool>& taken) const {
    std::vector<bool> poses(of_pose.size());
    for (std::size_t k = 0; k < poses.size(); ++k) poses[k] = taken[of_pose[k]];
    return poses;
  }
};

Configurations ConfigurationsOf(const Dataset& data) {
  constexpr double kStill = 1e-6;
  Configurations all;
  all.of_pose = GroupByConfiguration(data);
  const int count =
      all.of_pose.empty()
          ? 0
          : *std::max_element(all.of_pose.begin(), all.of_pose.end()) + 1;
  all.scaled.setZero(data.num_joints(), count);
  for (Eigen::Index k = 0; k < data.num_poses(); ++k) {
    all.scaled.col(all.of_pose[static_cast<std::size_t>(k)]) =
        data.joint_values.col(k);
  }
  for (Eigen::Index j = 0; j < all.scaled.rows(); ++j) {
    auto row = all.scaled.row(j).array();
    row -= row.mean();
    row /= std::max(kStill, std::sqrt(row.square().mean()));
  }
  return all;
}

int IndexBelow(Eigen::Index count, Random* random) {
  return std::min(
      static_cast<int>(count) - 1,
      static_cast<int>(random->Uniform() * static_cast<double>(count)));
}

std::vector<bool> RegionIn(const Configurations& all, double fraction,
                           std::uint64_t seed) {
  constexpr int kShare = 20;
  Random random(seed);
  const auto count = static_cast<int>(all.size());
  const auto wanted = static_cast<int>(std::ceil(fraction * count));
  const int each = std::max(1, count / kShare);
  std::vector<bool> taken(count, false);
  std::vector<int> order(count);
  int num_taken = 0;
  while (num_taken < wanted && num_taken < count) {
    const Eigen::VectorXd centre = all.scaled.col(IndexBelow(count, &random));
    const Eigen::VectorXd distances =
        (all.scaled.colwise() - centre).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), 0);
    std::nth_element(order.begin(), order.begin() + (each - 1), order.end(),
                     [&](int a, int b) {
                       return distances[a] != distances[b]
                                  ? distances[a] < distances[b]
                                  : a < b;
                     });
    for (int k = 0; k < each; ++k) {
      if (taken[order[k]]) continue;
      taken[order[k]] = true;
      ++num_taken;
    }
  }
  return taken;
}

// The configurations dealt out at random.
std::vector<int> Dealt(int count, int hands, std::uint64_t seed) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (int k = count - 1; k > 0; --k) {
    std::swap(order[k], order[IndexBelow(k + 1, &random)]);
  }
  std::vector<int> hand(count);
  for (int k = 0; k < count; ++k) hand[order[k]] = k % hands;
  return hand;
}

}  // namespace

std::vector<bool> RegionOf(const Dataset& data, double fraction,
                           std::uint64_t seed) {
  const Configurations all = ConfigurationsOf(data);
  return all.Poses(RegionIn(all, fraction, seed));
}

std::vector<bool> BlocksOf(const Dataset& data, double fraction,
                           std::uint64_t seed) {
  constexpr int kRuns = 20;
  const Configurations all = ConfigurationsOf(data);
  const auto count = static_cast<int>(all.size());
  const int runs = std::min(kRuns, std::max(1, count));
  const auto wanted = static_cast<int>(
      std::clamp(std::round(fraction * runs), 1.0, runs - 1.0));
  const std::vector<int> order = Dealt(runs, runs, seed);
  std::vector<bool> taken(count);
  for (int k = 0; k < count; ++k) {
    taken[k] = order[static_cast<std::int64_t>(k) * runs / count] < wanted;
  }
  return all.Poses(taken);
}

TrainingFolds MakeTrainingFolds(const Dataset& data) {
  const Configurations all = ConfigurationsOf(data);
  TrainingFolds folds;
  for (int k = 0; k < TrainingFolds::kRegions; ++k) {
    folds.left_out.push_back(
        all.Poses(RegionIn(all, kRegionFraction, kFirstRegionSeed + k)));
  }
  const auto count = static_cast<int>(all.size());
  const std::vector<int> hand =
      Dealt(count, TrainingFolds::kRandom, kRandomSeed);
  for (int fold = 0; fold < TrainingFolds::kRandom; ++fold) {
    std::vector<bool> taken(count);
    for (int k = 0; k < count; ++k) taken[k] = hand[k] == fold;
    folds.left_out.push_back(all.Poses(taken));
  }
  return folds;
}

}  // namespace alidade::internal
