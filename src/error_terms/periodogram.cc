#include "src/error_terms/periodogram.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "alidade/units.h"
#include "src/common/parallel.h"

namespace alidade::internal {
namespace {

// What one joint's frequencies are computed from.
struct JointRows {
  Eigen::VectorXd values;  // joint values, one per row
  Eigen::VectorXd turns;   // of the joint, weighted
  Eigen::VectorXd residuals;
  double range = 0.0;
};

JointRows RowsOf(const WeightedRows& data, const Eigen::VectorXd& residuals,
                 int joint) {
  const TermRows& rows = data.rows;
  const Eigen::Index size = rows.turns.rows();
  JointRows of{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size),
               Eigen::VectorXd::Zero(size)};
  for (std::size_t k = 0; k < rows.observations.size(); ++k) {
    const TermRows::Observation& one = rows.observations[k];
    if (one.pose < 0 || one.second_pose >= 0) continue;
    const double root = std::sqrt(data.weights[static_cast<Eigen::Index>(k)]);
    for (int row = 0; row < one.height; ++row) {
      const Eigen::Index i = one.first_row + row;
      of.values[i] = rows.joint_values(joint, one.pose);
      of.turns[i] = root * rows.turns(i, 3 * joint + 2);
      of.residuals[i] = root * residuals[i];
    }
  }
  of.range = rows.joint_values.row(joint).maxCoeff() -
             rows.joint_values.row(joint).minCoeff();
  return of;
}

struct Peak {
  double cycles = 0.0;
  double power = 0.0;      // b^T A^-1 b
  double amplitude = 0.0;  // in units of turns
};

Peak PowerAt(const JointRows& rows, double cycles) {
  const Eigen::ArrayXd phase = cycles * rows.values.array();
  const Eigen::VectorXd cosine = rows.turns.array() * phase.cos();
  const Eigen::VectorXd sine = rows.turns.array() * phase.sin();
  Eigen::Matrix2d products;
  products << cosine.squaredNorm(), cosine.dot(sine), cosine.dot(sine),
      sine.squaredNorm();
  const Eigen::Vector2d b(cosine.dot(rows.residuals), sine.dot(rows.residuals));
  const Eigen::Vector2d fitted = products.ldlt().solve(b);
  return {cycles, b.dot(fitted), fitted.norm()};
}

// The top of the peak, which lies within `step` of it.
Peak Refine(const JointRows& rows, Peak peak, double step) {
  constexpr int kHalvings = 6;
  for (int k = 0; k < kHalvings; ++k) {
    step *= 0.5;
    const double middle = peak.cycles;
    for (const double cycles : {middle - step, middle + step}) {
      const Peak beside = PowerAt(rows, cycles);
      if (beside.power > peak.power) peak = beside;
    }
  }
  return peak;
}

}  // namespace

std::vector<FoundHarmonic> FindHarmonics(const WeightedRows& data,
                                         const Eigen::VectorXd& residuals,
                                         const std::vector<bool>& is_revolute,
                                         int num_threads) {
  // Frequencies in one width of a peak.
  constexpr double kOversampling = 4.0;
  // Ranges of joints that are looked at (rad): farther ones, of dozens of
  // turns, have frequencies without end.
  constexpr double kShortest = 0.5;
  constexpr double kLongest = 40.0;
  const auto num_joints = static_cast<std::int64_t>(is_revolute.size());
  std::vector<Peak> highest(is_revolute.size());
  std::vector<double> independent(is_revolute.size(), 0.0);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < data.rows.observations.size(); ++k) {
    const TermRows::Observation& one = data.rows.observations[k];
    const double weight = data.weights[static_cast<Eigen::Index>(k)];
    sum += weight * residuals.segment(one.first_row, one.height).squaredNorm();
    count += weight * one.num_measured;
  }
  const double variance = sum / std::max(1.0, count);
  ParallelFor(
      num_threads, num_joints, 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t j = begin; j < end; ++j) {
          if (!is_revolute[j]) continue;
          const JointRows rows = RowsOf(data, residuals, static_cast<int>(j));
          if (rows.range < kShortest || !(rows.range <= kLongest) ||
              rows.turns.squaredNorm() == 0.0) {
            continue;
          }
          const double width = 2.0 * kPi / rows.range;
          independent[j] = (kMostCycles - kFewestCycles) / width;
          const auto places = static_cast<int>(kOversampling * independent[j]);
          for (int k = 0; k <= places; ++k) {
            const Peak peak =
                PowerAt(rows, kFewestCycles + k * width / kOversampling);
            if (peak.power > highest[j].power) highest[j] = peak;
          }
          highest[j] = Refine(rows, highest[j], width / kOversampling);
        }
      });
  double all = 0.0;
  for (const double some : independent) all += some;
  std::vector<FoundHarmonic> found;
  for (std::size_t j = 0; j < highest.size(); ++j) {
    const double chance = std::exp(-0.5 * highest[j].power / variance);
    const double false_alarm = -std::expm1(all * std::log1p(-chance));
    if (!(highest[j].power > 0.0) || !(false_alarm < kFalseAlarm)) continue;
    found.push_back({static_cast<int>(j), highest[j].cycles,
                     kTermUnit * highest[j].amplitude, false_alarm});
  }
  return found;
}

}  // namespace alidade::internal
