#include "src/uncertainty/looks.h"

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "src/identifiability/generic_data.h"
#include "src/kernel/holdout.h"
#include "src/kernel/measurement_model.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostPoses = 5000;

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

}  // namespace

Looks TakeLooks(const FittedProblem& fit) {
  Looks looks;
  looks.is_sample = fit.data.global_poses() > kMostPoses;
  looks.data = EvenSubset(fit.model.communicator(), fit.data, kMostPoses);
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
