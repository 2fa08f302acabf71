#include "src/uncertainty/expected_share.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "src/common/distributions.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

constexpr int kDraws = 400;
constexpr std::uint64_t kSeed = 1;
// Of the draws left out at either end: 2.5 %.
constexpr int kOutside = kDraws / 40;
// Positions, and draws of each one's measurement: the same for each draw of the
// parameters.
constexpr Eigen::Index kMostPositions = 48;
constexpr int kNoiseDraws = 16;

// An error of the parameters, and what sigma was estimated as, over sigma.
struct Draw {
  Eigen::VectorXd u;
  double scale = 1.0;
};

// Wilson and Hilferty 1931: the cube root of chi-square is nearly normal.
double DrawScale(double dof, Random* random) {
  if (!std::isfinite(dof)) return 1.0;
  const double spread = 2.0 / (9.0 * dof);
  const double root = 1.0 - spread + random->Normal() * std::sqrt(spread);
  return std::sqrt(std::max(0.0, root * root * root));
}

Draw MakeDraw(Eigen::Index parameters, double dof, Random* random) {
  Draw draw;
  draw.u.resize(parameters);
  for (double& entry : draw.u) entry = random->Normal();
  draw.scale = DrawScale(dof, random);
  return draw;
}

// The mean probability to be held, and that of a share of `all`.
double DrawShare(const Eigen::ArrayXd& probabilities, std::int64_t all,
                 Random* random) {
  const double variance =
      (probabilities * (1.0 - probabilities)).mean() / static_cast<double>(all);
  const double share =
      probabilities.mean() + random->Normal() * std::sqrt(variance);
  return std::clamp(share, 0.0, 1.0);
}

std::pair<double, double> Middle(std::vector<double> shares) {
  std::sort(shares.begin(), shares.end());
  return {shares[kOutside], shares[kDraws - 1 - kOutside]};
}

}  // namespace

std::pair<double, double> ExpectedShares(const PredictedRows& rows,
                                         double confidence, double dof) {
  Random random(kSeed);
  const double quantile = StudentTQuantile(0.5 + 0.5 * confidence, dof);
  const Eigen::VectorXd bounds =
      quantile * (1.0 + rows.spread.rowwise().squaredNorm().array()).sqrt();
  std::vector<double> shares;
  Eigen::ArrayXd held(rows.spread.rows());
  for (int k = 0; k < kDraws; ++k) {
    const Draw draw = MakeDraw(rows.spread.cols(), dof, &random);
    const Eigen::VectorXd shift = rows.spread * draw.u;
    for (Eigen::Index i = 0; i < held.size(); ++i) {
      const double bound = draw.scale * bounds[i];
      held[i] = NormalCdf(bound - shift[i]) - NormalCdf(-bound - shift[i]);
    }
    shares.push_back(DrawShare(held, rows.all, &random));
  }
  return Middle(std::move(shares));
}

std::pair<double, double> ExpectedEllipsoidShares(const PredictedRows& rows,
                                                  double confidence,
                                                  double dof) {
  Random random(kSeed);
  const double bound = 3.0 * FisherQuantile(confidence, 3.0, dof);
  const Eigen::Index all = rows.spread.rows() / 3;
  const Eigen::Index stride = (all + kMostPositions - 1) / kMostPositions;
  const Eigen::Index positions = (all + stride - 1) / stride;
  std::vector<Eigen::Matrix3d> factors;
  Eigen::MatrixXd spread(3 * positions, rows.spread.cols());
  for (Eigen::Index i = 0; i < positions; ++i) {
    const auto three = rows.spread.middleRows(3 * i * stride, 3);
    spread.middleRows(3 * i, 3) = three;
    // Dynamic, for which Cholesky's decomposition is compiled already.
    Eigen::MatrixXd covariance = three * three.transpose();
    covariance.diagonal().array() += 1.0;
    factors.emplace_back(covariance.llt().matrixL());
  }
  Eigen::Matrix3Xd noise(3, positions * kNoiseDraws);
  for (double& entry : noise.reshaped()) entry = random.Normal();
  std::vector<double> shares;
  Eigen::ArrayXd held(positions);
  for (int k = 0; k < kDraws; ++k) {
    const Draw draw = MakeDraw(rows.spread.cols(), dof, &random);
    const Eigen::VectorXd shift = spread * draw.u;
    for (Eigen::Index i = 0; i < positions; ++i) {
      int count = 0;
      for (int n = 0; n < kNoiseDraws; ++n) {
        Eigen::Vector3d error =
            shift.segment<3>(3 * i) + noise.col(i * kNoiseDraws + n);
        factors[i].triangularView<Eigen::Lower>().solveInPlace(error);
        count += error.squaredNorm() <= bound * draw.scale * draw.scale ? 1 : 0;
      }
      held[i] = static_cast<double>(count) / kNoiseDraws;
    }
    shares.push_back(DrawShare(held, rows.all, &random));
  }
  return Middle(std::move(shares));
}

}  // namespace alidade::internal
