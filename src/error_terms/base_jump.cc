#include "src/error_terms/base_jump.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/distributions.h"

namespace alidade::internal {
namespace {

// Sums over the rows of a stretch of poses. Dynamic, for which decompositions
// are compiled already.
struct Sums {
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(6);
  double squares = 0.0;
  double count = 0.0;

  void Add(const Sums& other) {
    products += other.products;
    gradient += other.gradient;
    squares += other.squares;
    count += other.count;
  }
};

std::vector<Sums> SumByPlace(const WeightedRows& data,
                             const Eigen::VectorXd& residuals, int places) {
  const TermRows& rows = data.rows;
  std::vector<Sums> sums(places);
  const Eigen::Index num_poses = rows.joint_values.cols();
  for (std::size_t k = 0; k < rows.observations.size(); ++k) {
    const TermRows::Observation& one = rows.observations[k];
    if (one.pose < 0 || one.second_pose >= 0) continue;
    const double weight = data.weights[static_cast<Eigen::Index>(k)];
    Sums& sum = sums[static_cast<std::size_t>(Eigen::Index{places} * one.pose /
                                              num_poses)];
    const auto base = rows.turns.middleRows(one.first_row, one.height)
                          .middleCols<6>(Eigen::Index{3} * rows.num_joints());
    const auto left = residuals.segment(one.first_row, one.height);
    sum.products += weight * base.transpose() * base;
    sum.gradient += weight * base.transpose() * left;
    sum.squares += weight * left.squaredNorm();
    sum.count += weight * one.num_measured;
  }
  return sums;
}

}  // namespace

std::optional<BaseJump> FindBaseJump(const WeightedRows& data,
                                     const Eigen::VectorXd& residuals) {
  constexpr int kMostPlaces = 100;
  constexpr Eigen::Index kFewest = 20;
  const Eigen::Index num_poses = data.rows.joint_values.cols();
  if (num_poses < kFewest) return std::nullopt;
  const int places =
      static_cast<int>(std::min<Eigen::Index>(kMostPlaces, num_poses / 4));
  const std::vector<Sums> sums = SumByPlace(data, residuals, places);
  Sums all;
  for (const Sums& sum : sums) all.Add(sum);
  const Eigen::LDLT<Eigen::MatrixXd> factor(all.products);
  const double variance = all.squares / std::max(1.0, all.count - 6.0);
  if (factor.info() != Eigen::Success || !(variance > 0.0)) return std::nullopt;
  const Eigen::VectorXd all_moved = factor.solve(all.gradient);
  Sums after;
  BaseJump best;
  double most = 0.0;
  for (int place = places - 1; place > 0; --place) {
    after.Add(sums[place]);
    // A base for the rows before it, too.
    if (place < 2 || place > places - 2) continue;
    const Eigen::MatrixXd shared = factor.solve(after.products);
    const Eigen::MatrixXd own = after.products - after.products * shared;
    const Eigen::VectorXd b = after.gradient - after.products * all_moved;
    const Eigen::VectorXd move = own.ldlt().solve(b);
    const double gain = b.dot(move);
    if (!(gain > most)) continue;
    most = gain;
    best.pose = static_cast<int>((num_poses * place + places - 1) / places);
    best.distance = std::sqrt(std::max(
        0.0, move.dot(after.products * move) / std::max(1.0, after.count)));
  }
  best.false_alarm =
      std::min(1.0, places * ChiSquareSurvival(most / variance, 6.0));
  if (!(best.false_alarm < kJumpFalseAlarm)) return std::nullopt;
  return best;
}

}  // namespace alidade::internal
