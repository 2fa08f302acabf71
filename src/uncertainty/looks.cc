#include "src/uncertainty/looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "src/identifiability/generic_data.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostLookedAt = 5000;

// Whitened, stacked.
Eigen::VectorXd WhitenedResiduals(const FittedProblem& fit,
                                  const Dataset& data) {
  Eigen::VectorXd all = fit.model.Errors(fit.values, data).map();
  Eigen::Index first = 0;
  for (const ObservationBlock& block : data.blocks) {
    const Eigen::Index rows = block.rows_each() * block.size();
    Eigen::MatrixXd of_block = all.segment(first, rows);
    Whiten(block, 0, block.size(), of_block);
    all.segment(first, rows) = of_block;
    first += rows;
  }
  return all;
}

// Whether an observation is one at all, and the fit has not given it up.
bool Counts(const FittedProblem& fit, const ObservationBlock& block,
            Eigen::Index i, const Eigen::VectorXd& residual) {
  constexpr double kLeastWeight = 0.5;
  const Eigen::Index dimension = block.sigmas.col(i).array().isFinite().count();
  if (dimension == 0) return false;
  if (fit.losses.empty()) return true;
  std::array<double, 3> rho{};
  fit.losses[dimension - 1].Evaluate(residual.squaredNorm(), rho.data());
  return rho[1] >= kLeastWeight;
}

// The observations of a block that are looks at the same, with the same sigmas,
// each in the order of its first one.
std::vector<std::vector<Eigen::Index>> Repeats(
    const FittedProblem& fit, const ObservationBlock& block,
    const std::vector<int>& groups,
    const Eigen::Ref<const Eigen::VectorXd>& residuals) {
  using Key = std::tuple<int, int, int, int, std::vector<double>>;
  std::map<Key, std::size_t> known;
  std::vector<std::vector<Eigen::Index>> all;
  const Eigen::Index rows = block.rows_each();
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    if (!Counts(fit, block, i, residuals.segment(i * rows, rows))) continue;
    if (block.kind == MeasurementKind::kPointDistance) {
      all.push_back({i});
      continue;
    }
    const Eigen::VectorXd sigmas = block.sigmas.col(i);
    const int second = block.kind == MeasurementKind::kDifference
                           ? groups[block.seconds[i]]
                           : 0;
    const int reference = block.references.empty() ? 0 : block.references[i];
    const auto [place, is_new] =
        known.emplace(Key(groups[block.pose(i)], block.target(i), reference,
                          second, {sigmas.begin(), sigmas.end()}),
                      all.size());
    if (is_new) all.emplace_back();
    all[place->second].push_back(i);
  }
  return all;
}

void AddSpread(const ObservationBlock& block, Eigen::Index i,
               const Eigen::VectorXd& about_mean, std::size_t repeats,
               Looks* looks) {
  const double freedom = 1.0 - 1.0 / static_cast<double>(repeats);
  for (int row = 0; row < block.rows_each(); ++row) {
    if (std::isinf(block.sigmas(row, i))) continue;
    const int which = row < 3 ? kLengths : kRotations;
    looks->repeat_squares[which] += about_mean[row] * about_mean[row];
    looks->repeat_freedom[which] += freedom;
  }
}

// Configurations of which all observations are taken: single ones of a
// configuration that was measured again and again would say nothing of how well
// it repeats.
Dataset SampleOfConfigurations(const FittedProblem& fit) {
  Communicator* const communicator = fit.model.communicator();
  const double left_out =
      1.0 - static_cast<double>(kMostLookedAt) /
                static_cast<double>(fit.data.global_poses());
  const std::vector<char> is_left_out =
      DrawHeldOut(fit.data, left_out, 1, communicator);
  std::vector<Eigen::Index> poses;
  for (std::size_t pose = 0; pose < is_left_out.size(); ++pose) {
    if (is_left_out[pose] == 0) {
      poses.push_back(static_cast<Eigen::Index>(pose));
    }
  }
  return GatherData(communicator, fit.data, SelectPoses(fit.data, poses));
}

// Cuts list[begin, end) in two, and each part again, at medians of the joint
// whose values differ most.
class Cutter {
 public:
  // `places`: joint values of each configuration, comparable between joints.
  explicit Cutter(const Eigen::MatrixXd& places)
      : places_(places),
        list_(static_cast<std::size_t>(places.cols())),
        blocks_(list_.size()) {
    std::iota(list_.begin(), list_.end(), 0);
  }

  std::vector<int> Cut(int depth) {
    Cut(0, static_cast<std::ptrdiff_t>(list_.size()), depth);
    return std::move(blocks_);
  }

 private:
  void Cut(std::ptrdiff_t begin, std::ptrdiff_t end, int depth) {
    if (depth == 0) {
      for (auto k = begin; k < end; ++k) {
        blocks_[list_[static_cast<std::size_t>(k)]] = count_;
      }
      ++count_;
      return;
    }
    Eigen::VectorXd low = places_.col(list_[static_cast<std::size_t>(begin)]);
    Eigen::VectorXd high = low;
    for (auto k = begin; k < end; ++k) {
      const auto place = places_.col(list_[static_cast<std::size_t>(k)]);
      low = low.cwiseMin(place);
      high = high.cwiseMax(place);
    }
    Eigen::Index joint = 0;
    (high - low).maxCoeff(&joint);
    const std::ptrdiff_t middle = begin + (end - begin) / 2;
    std::nth_element(list_.begin() + begin, list_.begin() + middle,
                     list_.begin() + end, [&](int a, int b) {
                       return std::make_pair(places_(joint, a), a) <
                              std::make_pair(places_(joint, b), b);
                     });
    Cut(begin, middle, depth - 1);
    Cut(middle, end, depth - 1);
  }

  const Eigen::MatrixXd& places_;
  std::vector<int> list_;
  std::vector<int> blocks_;
  int count_ = 0;
};

}  // namespace

std::vector<int> BlocksOfNeighbours(const Looks& looks, int parameters) {
  constexpr int kFewest = 4;  // configurations
  int count = 0;
  for (const int number : looks.configurations) {
    count = std::max(count, number + 1);
  }
  int depth = 0;
  while ((1 << depth) < 2 * parameters) ++depth;
  if (kFewest * (1 << depth) > count) return {};
  const auto joints = looks.data.joint_values.map();
  Eigen::MatrixXd places(joints.rows(), count);
  for (Eigen::Index i = joints.cols() - 1; i >= 0; --i) {
    places.col(looks.configurations[static_cast<std::size_t>(i)]) =
        joints.col(i);
  }
  const Eigen::VectorXd range =
      places.rowwise().maxCoeff() - places.rowwise().minCoeff();
  for (Eigen::Index j = 0; j < range.size(); ++j) {
    if (range[j] > 0.0) places.row(j) /= range[j];
  }
  return Cutter(places).Cut(depth);
}

Looks TakeLooks(const FittedProblem& fit, bool has_repeats) {
  Looks looks;
  looks.is_sample = fit.data.global_poses() > kMostLookedAt;
  looks.data =
      looks.is_sample && has_repeats
          ? SampleOfConfigurations(fit)
          : EvenSubset(fit.model.communicator(), fit.data, kMostLookedAt);
  looks.configurations = GroupByConfiguration(looks.data);
  const std::vector<int> groups = GroupByJointValues(looks.data);
  const Eigen::VectorXd residuals = WhitenedResiduals(fit, looks.data);
  std::vector<double> means;
  Eigen::Index first = 0;
  for (ObservationBlock& block : looks.data.blocks) {
    const Eigen::Index rows = block.rows_each();
    std::vector<Eigen::Index> taken;
    for (const std::vector<Eigen::Index>& same :
         Repeats(fit, block, groups,
                 residuals.segment(first, rows * block.size()))) {
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(rows);
      for (const Eigen::Index i : same) {
        mean += residuals.segment(first + i * rows, rows);
      }
      mean /= static_cast<double>(same.size());
      for (const Eigen::Index i : same) {
        if (same.size() < 2) continue;
        AddSpread(block, i, residuals.segment(first + i * rows, rows) - mean,
                  same.size(), &looks);
      }
      means.insert(means.end(), mean.begin(), mean.end());
      looks.counts.push_back(static_cast<int>(same.size()));
      taken.push_back(same.front());
    }
    first += rows * block.size();
    if (static_cast<Eigen::Index>(taken.size()) == block.size()) continue;
    const bool has_poses = block.kind != MeasurementKind::kPointDistance;
    block = TakeObservations(block, taken);
    if (!has_poses) block.poses.clear();
  }
  looks.residuals = Eigen::Map<const Eigen::VectorXd>(
      means.data(), static_cast<Eigen::Index>(means.size()));
  return looks;
}

}  // namespace alidade::internal
