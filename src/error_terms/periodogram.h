#ifndef ALIDADE_SRC_ERROR_TERMS_PERIODOGRAM_H_
#define ALIDADE_SRC_ERROR_TERMS_PERIODOGRAM_H_

#include <Eigen/Core>
#include <vector>

#include "src/error_terms/term_normal.h"

namespace alidade::internal {

/// A harmonic that residuals have beyond chance.
struct FoundHarmonic {
  int joint = 0;
  double cycles = 0.0;     ///< per turn of the joint
  double amplitude = 0.0;  ///< rad
  /// How likely noise alone has a peak so high at any joint and frequency.
  double false_alarm = 1.0;
};

/// Cycles per turn that are looked at: errors of the teeth of gears. Below are
/// the joint functions.
constexpr double kFewestCycles = 12.0;
constexpr double kMostCycles = 400.0;
/// Peaks that noise has more often are none.
constexpr double kFalseAlarm = 1e-3;

/// The least-squares periodogram of residuals (rows of `data`) along each
/// revolute joint's turn, over its value: with b the products of residuals and
/// columns z cos(f q), z sin(f q), and A those of the columns among each other,
///
///   P(f) = b^T A^-1 b / variance
///
/// which is chi-square of two degrees of freedom where there is noise alone, so
/// that the largest of M independent frequencies exceeds P with probability 1 -
/// (1 - exp(-P / 2))^M (Lomb 1976; Scargle 1982; of weighted columns
/// Zechmeister and Kuerster 2009). Highest peak of each joint, as far as it is
/// below kFalseAlarm. O(joints frequencies rows).
std::vector<FoundHarmonic> FindHarmonics(const WeightedRows& data,
                                         const Eigen::VectorXd& residuals,
                                         const std::vector<bool>& is_revolute,
                                         int num_threads);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_ERROR_TERMS_PERIODOGRAM_H_
