#ifndef ALIDADE_SRC_UNCERTAINTY_EXPECTED_SHARE_H_
#define ALIDADE_SRC_UNCERTAINTY_EXPECTED_SHARE_H_

#include <Eigen/Core>
#include <cstdint>
#include <utility>

namespace alidade::internal {

/// Predictions of rows: J root, a row each, of what was measured (whitened), so
/// that a deviation from what is predicted is n + (J root) u, n of the
/// measurement and u of the parameters, both standard normal.
struct PredictedRows {
  Eigen::MatrixXd spread;  ///< rows x parameters
  std::int64_t all = 0;    ///< rows that these are an even selection of
};

/// Between which shares of deviations lie within their intervals by chance, in
/// 95 % of all calibrations, where the prediction is right. All rows share the
/// one error u of the parameters, and the one estimate of sigma: with
/// c^2 = chi^2 / dof, t the quantile and s_i^2 = 1 + |(J root)_i|^2,
///
///   q_i(u, c) = P(|n + (J root)_i u| <= c t s_i)
///
/// is averaged over the rows for each of 400 draws of (u, c), and the share
/// that comes of it drawn with the variance mean(q_i (1 - q_i)) / all. A
/// binomial interval would take the rows for independent, and be too narrow by
/// far where they are many. O(400 rows p); seeded, so that the bits repeat.
/// @pre rows.all > 0, rows.spread has a row.
std::pair<double, double> ExpectedShares(const PredictedRows& rows,
                                         double confidence, double dof);

/// The same of positions within their ellipsoids |L^-1 e|^2 <= 3 F c^2, three
/// consecutive rows each; `all` counts positions.
std::pair<double, double> ExpectedEllipsoidShares(const PredictedRows& rows,
                                                  double confidence,
                                                  double dof);

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_UNCERTAINTY_EXPECTED_SHARE_H_
