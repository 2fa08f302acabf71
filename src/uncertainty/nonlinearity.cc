#include "src/uncertainty/nonlinearity.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/constants.h"
#include "src/identifiability/generic_data.h"
#include "src/kernel/partition.h"

namespace alidade::internal {
namespace {

constexpr Eigen::Index kMostPoses = 1000;

// A bound this many linear ones away is none.
constexpr double kFarthest = 20.0;

// Relative accuracy of a bound, in quantiles.
constexpr double kBoundTolerance = 1e-4;

class Curvature {
 public:
  Curvature(const FittedProblem& fit, const ParameterCovariance& covariance,
            const Dataset& data)
      : fit_(fit), covariance_(covariance), data_(data) {
    fit.model.Linearize(fit.values, data, covariance.columns, &here_);
    spread_ = here_.jacobian * covariance.root;
  }

  // A^T H_ij for one i: entry (m, j).
  Eigen::MatrixXd Along(Eigen::Index i) {
    const Eigen::MatrixXd difference = JacobianAt(i, 1.0) - JacobianAt(i, -1.0);
    return 0.5 * spread_.transpose() * (difference * covariance_.root);
  }

 private:
  Eigen::MatrixXd JacobianAt(Eigen::Index i, double step) {
    Eigen::VectorXd moved = fit_.values;
    for (int k = 0; k < covariance_.size(); ++k) {
      moved[covariance_.columns[k]] += step * covariance_.root(k, i);
    }
    Linearization there;
    fit_.model.Linearize(moved, data_, covariance_.columns, &there);
    return there.jacobian;
  }

  const FittedProblem& fit_;
  const ParameterCovariance& covariance_;
  const Dataset& data_;
  Linearization here_;
  Eigen::MatrixXd spread_;
};

// One side of a profile: the distance at which the signed root of the cost's
// growth reaches the quantile.
class ProfileSide {
 public:
  ProfileSide(const FittedProblem& fit, int column, double fit_cost,
              const Resolve& resolve)
      : fit_(fit), column_(column), fit_cost_(fit_cost), resolve_(resolve) {}

  // `first`: the linear bound's distance, signed.
  double Find(double first, double quantile) {
    Eigen::VectorXd start = fit_.values;
    double below = 0.0;
    double below_root = 0.0;
    double above = kInfinity;
    double distance = first;
    for (int step = 0; step < 30; ++step) {
      Eigen::VectorXd values = start;
      const double root = RootAt(distance, &values);
      if (!std::isfinite(root)) return kInfinity;
      if (std::abs(root - quantile) <= kBoundTolerance * quantile) break;
      if (root < quantile) {
        // Roots are close to a straight line from here on.
        const double slope = (root - below_root) / (distance - below);
        below = distance;
        below_root = root;
        start = values;
        distance = Next(slope, quantile, above, first, distance, root);
      } else {
        above = distance;
        const double slope = (root - below_root) / (distance - below);
        distance = below + (quantile - below_root) / slope;
      }
      if (std::abs(distance) > kFarthest * std::abs(first)) return kInfinity;
    }
    return distance;
  }

 private:
  static double Next(double slope, double quantile, double above, double first,
                     double distance, double root) {
    const double sign = first < 0.0 ? -1.0 : 1.0;
    const double most = std::isfinite(above) ? 0.5 * (distance + above)
                                             : distance + 2.0 * first;
    const double secant = distance + (quantile - root) / slope;
    if (!std::isfinite(secant) || (secant - distance) * sign <= 0.0) {
      return most;
    }
    if (std::isfinite(above)) {
      return (secant - above) * sign < 0.0 ? secant : most;
    }
    return (secant - most) * sign < 0.0 ? secant : most;
  }

  double RootAt(double distance, Eigen::VectorXd* values) {
    (*values)[column_] = fit_.values[column_] + distance;
    const std::optional<double> cost = resolve_(column_, values);
    if (!cost) return kInfinity;
    return std::sqrt(std::max(0.0, *cost - fit_cost_));
  }

  const FittedProblem& fit_;
  const int column_;
  const double fit_cost_;
  const Resolve& resolve_;
};

}  // namespace

Eigen::VectorXd MeasureNonlinearity(const FittedProblem& fit,
                                    const ParameterCovariance& covariance) {
  const Eigen::Index p = covariance.size();
  Eigen::VectorXd nonlinearity = Eigen::VectorXd::Zero(p);
  if (p == 0 || fit.data.global_poses() == 0) return nonlinearity;
  const Dataset sample =
      EvenSubset(fit.model.communicator(), fit.data, kMostPoses);
  // What of the data the sample stands for.
  const double factor =
      static_cast<double>(GlobalEquations(fit.model.communicator(), fit.data)) /
      static_cast<double>(sample.num_equations());
  const Eigen::MatrixXd directions = covariance.root.rowwise().normalized();
  Curvature curvature(fit, covariance, sample);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(p);
  Eigen::VectorXd traces = Eigen::VectorXd::Zero(p);
  for (Eigen::Index i = 0; i < p; ++i) {
    // Row k: Q_k,ij over j.
    const Eigen::MatrixXd rows = factor * directions * curvature.Along(i);
    squares += rows.rowwise().squaredNorm();
    traces += rows.col(i);
  }
  nonlinearity =
      (0.5 * squares.array() + 0.25 * traces.array().square()).sqrt();
  for (int k = 0; k < covariance.size(); ++k) {
    if (!covariance.IsTold(k)) nonlinearity[k] = kInfinity;
  }
  return nonlinearity;
}

ConfidenceInterval ProfileInterval(const FittedProblem& fit,
                                   const ParameterCovariance& covariance,
                                   int index, double quantile, double fit_cost,
                                   const Resolve& resolve) {
  const int column = covariance.columns[index];
  const double estimate = fit.values[column];
  const double deviation = covariance.root.row(index).norm();
  ConfidenceInterval interval;
  interval.is_profile = true;
  interval.lower = -kInfinity;
  interval.upper = kInfinity;
  if (!covariance.IsTold(index)) return interval;
  ProfileSide side(fit, column, fit_cost, resolve);
  const double down = side.Find(-quantile * deviation, quantile);
  const double up = side.Find(quantile * deviation, quantile);
  if (std::isfinite(down)) interval.lower = estimate + down;
  if (std::isfinite(up)) interval.upper = estimate + up;
  return interval;
}

}  // namespace alidade::internal
