#include "src/planning/travel.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace alidade::internal {
namespace {

// Nearest neighbours are followed from so many poses.
constexpr int kMostStarts = 50;

// A way must become shorter by this part to count, so that rounding does not
// turn pieces round for ever.
constexpr double kSmallestGain = 1e-12;

class WayFinder {
 public:
  WayFinder(const Eigen::MatrixXd& joint_values, const Eigen::VectorXd& weights)
      : size_(static_cast<int>(joint_values.cols())), distances_(size_, size_) {
    for (int i = 0; i < size_; ++i) {
      for (int k = 0; k < size_; ++k) {
        distances_(i, k) =
            Travel(joint_values.col(i), joint_values.col(k), weights);
      }
    }
    smallest_gain_ = kSmallestGain * distances_.maxCoeff();
  }

  std::vector<int> Find() const {
    std::vector<int> best;
    double shortest = std::numeric_limits<double>::infinity();
    const int step = std::max(1, size_ / kMostStarts);
    for (int first = 0; first < size_; first += step) {
      std::vector<int> order = FollowNearest(first);
      const double length = Length(order);
      if (length < shortest) {
        shortest = length;
        best = std::move(order);
      }
    }
    while (TurnRound(&best) || MovePieces(&best)) {
    }
    return best;
  }

 private:
  double Length(const std::vector<int>& order) const {
    double length = 0.0;
    for (int i = 0; i + 1 < size_; ++i) {
      length += distances_(order[i], order[i + 1]);
    }
    return length;
  }

  std::vector<int> FollowNearest(int first) const {
    std::vector<int> order = {first};
    std::vector<bool> visited(size_, false);
    visited[first] = true;
    while (static_cast<int>(order.size()) < size_) {
      int nearest = -1;
      for (int k = 0; k < size_; ++k) {
        if (visited[k]) continue;
        if (nearest < 0 ||
            distances_(order.back(), k) < distances_(order.back(), nearest)) {
          nearest = k;
        }
      }
      visited[nearest] = true;
      order.push_back(nearest);
    }
    return order;
  }

  // Of the step from place i - 1 to i; no step leads to the ends.
  double Step(const std::vector<int>& order, int i) const {
    return i == 0 || i == size_ ? 0.0 : distances_(order[i - 1], order[i]);
  }

  bool TurnRound(std::vector<int>* order) const {
    bool shorter = false;
    for (int begin = 0; begin < size_; ++begin) {
      for (int end = begin + 2; end <= size_; ++end) {
        const double before = Step(*order, begin) + Step(*order, end);
        double after = 0.0;
        if (begin > 0) {
          after += distances_((*order)[begin - 1], (*order)[end - 1]);
        }
        if (end < size_) after += distances_((*order)[begin], (*order)[end]);
        if (after >= before - smallest_gain_) continue;
        std::reverse(order->begin() + begin, order->begin() + end);
        shorter = true;
      }
    }
    return shorter;
  }

  bool MovePieces(std::vector<int>* order) const {
    bool shorter = false;
    double length = Length(*order);
    for (int count = 1; count <= 3; ++count) {
      for (int begin = 0; begin + count <= size_; ++begin) {
        if (!MovePiece(begin, count, order)) continue;
        const double moved = Length(*order);
        shorter = shorter || moved < length - smallest_gain_;
        length = moved;
      }
    }
    return shorter;
  }

  // Takes poses out and puts them, in their order, where the way becomes
  // shortest.
  bool MovePiece(int begin, int count, std::vector<int>* order) const {
    std::vector<int> rest = *order;
    const std::vector<int> piece(rest.begin() + begin,
                                 rest.begin() + begin + count);
    rest.erase(rest.begin() + begin, rest.begin() + begin + count);
    const auto size = static_cast<int>(rest.size());
    const auto cost = [&](int place) {
      double added = 0.0;
      if (place > 0) added += distances_(rest[place - 1], piece.front());
      if (place < size) added += distances_(piece.back(), rest[place]);
      if (place > 0 && place < size) {
        added -= distances_(rest[place - 1], rest[place]);
      }
      return added;
    };
    int best = begin;
    for (int place = 0; place <= size; ++place) {
      if (cost(place) < cost(best) - smallest_gain_) best = place;
    }
    if (best == begin) return false;
    rest.insert(rest.begin() + best, piece.begin(), piece.end());
    *order = std::move(rest);
    return true;
  }

  const int size_;
  Eigen::MatrixXd distances_;
  double smallest_gain_ = 0.0;
};

}  // namespace

double Travel(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
              const Eigen::VectorXd& weights) {
  return (to - from).cwiseAbs().cwiseProduct(weights).maxCoeff();
}

double TravelAlong(const Eigen::MatrixXd& joint_values,
                   const Eigen::VectorXd& weights,
                   const std::vector<int>& order) {
  double travel = 0.0;
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    travel += Travel(joint_values.col(order[i]), joint_values.col(order[i + 1]),
                     weights);
  }
  return travel;
}

std::vector<int> ShortOrder(const Eigen::MatrixXd& joint_values,
                            const Eigen::VectorXd& weights) {
  if (joint_values.cols() == 0) return {};
  return WayFinder(joint_values, weights).Find();
}

}  // namespace alidade::internal
