// Between which shares of coordinates and positions are held where a prediction
// is right, against simulations of it.

#include "src/uncertainty/expected_share.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "src/common/constants.h"
#include "src/common/distributions.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

constexpr double kConfidence = 0.9;
constexpr int kDraws = 2000;
// Looks at each row of the spread.
constexpr int kLooks = 10;

PredictedRows RandomRows(Eigen::Index rows, double size) {
  Random random(470);
  PredictedRows predicted;
  predicted.spread.resize(rows, 2);
  for (double& entry : predicted.spread.reshaped()) {
    entry = size * random.Normal();
  }
  return predicted;
}

// The root of chi-square over its degrees of freedom, by its definition.
double DrawScale(int dof, Random* random) {
  double sum = 0.0;
  for (int k = 0; k < dof; ++k) sum += std::pow(random->Normal(), 2);
  return std::sqrt(sum / dof);
}

std::pair<double, double> Middle(std::vector<double> shares) {
  std::sort(shares.begin(), shares.end());
  return {shares[kDraws / 40], shares[kDraws - 1 - kDraws / 40]};
}

// Of 400 draws an end has a standard error of a seventh of the shares' standard
// deviation, and of more where they have a tail; `deviation` is that of all.
void ExpectNear(const std::pair<double, double>& actual,
                const std::pair<double, double>& expected, double deviation) {
  EXPECT_NEAR(actual.first, expected.first, 0.7 * deviation);
  EXPECT_NEAR(actual.second, expected.second, 0.5 * deviation);
}

double DeviationOf(const std::vector<double>& shares) {
  const auto all = Eigen::Map<const Eigen::ArrayXd>(
      shares.data(), static_cast<Eigen::Index>(shares.size()));
  return std::sqrt((all - all.mean()).square().mean());
}

TEST(ExpectedSharesTest, OfKnownParametersAreThoseOfABinomial) {
  PredictedRows rows;
  rows.spread = Eigen::MatrixXd::Zero(30, 2);
  rows.all = 400;
  // 0.9 +- 1.96 standard deviations of 0.015.
  ExpectNear(ExpectedShares(rows, kConfidence, kInfinity), {0.8706, 0.9294},
             0.015);
  rows.all = 100;
  ExpectNear(ExpectedShares(rows, kConfidence, kInfinity), {0.8412, 0.9588},
             0.03);
}

// Nothing but sigma is unknown, of five degrees of freedom: 2.5 % of estimates
// are below sqrt(0.8312 / 5) sigma, 2.015 times which hold 0.5887, and 2.5 %
// above sqrt(12.83 / 5) sigma, which hold 0.9988.
TEST(ExpectedSharesTest, OfAnEstimatedSigmaFollowItsDistribution) {
  PredictedRows rows;
  rows.spread = Eigen::MatrixXd::Zero(3, 2);
  rows.all = 100000000;
  // The cube root is off by 0.01 there, and 400 draws by 0.02.
  const auto shares = ExpectedShares(rows, kConfidence, 5.0);
  EXPECT_NEAR(shares.first, 0.5887, 0.03);
  EXPECT_NEAR(shares.second, 0.9988, 0.001);
}

TEST(ExpectedSharesTest, AreThoseOfASimulation) {
  constexpr int kDof = 12;
  PredictedRows rows = RandomRows(40, 0.35);
  rows.all = 40 * kLooks;
  Random random(471);
  const double quantile = StudentTQuantile(0.5 + 0.5 * kConfidence, kDof);
  std::vector<double> shares;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Vector2d u(random.Normal(), random.Normal());
    const double scale = DrawScale(kDof, &random);
    int held = 0;
    for (Eigen::Index i = 0; i < 40; ++i) {
      const double std = std::sqrt(1.0 + rows.spread.row(i).squaredNorm());
      for (int look = 0; look < kLooks; ++look) {
        const double error = rows.spread.row(i).dot(u) + random.Normal();
        held += std::abs(error) <= quantile * scale * std ? 1 : 0;
      }
    }
    shares.push_back(held / (40.0 * kLooks));
  }
  ExpectNear(ExpectedShares(rows, kConfidence, kDof), Middle(shares),
             DeviationOf(shares));
}

TEST(ExpectedSharesTest, OfEllipsoidsAreThoseOfASimulation) {
  constexpr int kDof = 12;
  PredictedRows rows = RandomRows(3 * 40, 0.35);
  rows.all = 40 * kLooks;
  Random random(472);
  const double bound = 3.0 * FisherQuantile(kConfidence, 3.0, kDof);
  std::vector<double> shares;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Vector2d u(random.Normal(), random.Normal());
    const double scale = DrawScale(kDof, &random);
    int held = 0;
    for (int i = 0; i < 40; ++i) {
      const Eigen::MatrixXd spread = rows.spread.middleRows(3 * i, 3);
      const Eigen::Matrix3d weight =
          (Eigen::Matrix3d::Identity() + spread * spread.transpose()).inverse();
      for (int look = 0; look < kLooks; ++look) {
        Eigen::Vector3d error = spread * u;
        for (double& entry : error) entry += random.Normal();
        held += error.dot(weight * error) <= bound * scale * scale ? 1 : 0;
      }
    }
    shares.push_back(held / (40.0 * kLooks));
  }
  ExpectNear(ExpectedEllipsoidShares(rows, kConfidence, kDof), Middle(shares),
             DeviationOf(shares));
}

// Of more than 48 positions some are looked at: of 100 that are alike, as if
// there were fewer.
TEST(ExpectedSharesTest, OfManyEllipsoidsAreThoseOfSome) {
  PredictedRows rows;
  rows.spread = Eigen::MatrixXd::Constant(300, 1, 0.3);
  rows.all = 1000;
  PredictedRows few = rows;
  few.spread = rows.spread.topRows(120);
  ExpectNear(ExpectedEllipsoidShares(rows, kConfidence, 50.0),
             ExpectedEllipsoidShares(few, kConfidence, 50.0), 0.05);
}

}  // namespace
}  // namespace alidade::internal
