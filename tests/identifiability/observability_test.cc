#include "src/identifiability/observability.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "src/common/random.h"

namespace alidade::internal {
namespace {

TEST(ObservabilityTest, IndicesOfKnownSingularValues) {
  const Eigen::Vector3d s(8.0, 4.0, 2.0);
  const ObservabilityIndices indices =
      ComputeObservability(Eigen::MatrixXd(s.asDiagonal()), 16);
  EXPECT_NEAR(indices.o1, 1.0, 1e-14);  // cube root of 64, over sqrt(16)
  EXPECT_NEAR(indices.o2, 0.25, 1e-15);
  EXPECT_NEAR(indices.o3, 2.0, 1e-14);
  EXPECT_NEAR(indices.o4, 0.5, 1e-14);
  EXPECT_NEAR(indices.o5, 8.0 / 7.0, 1e-14);
  EXPECT_NEAR(indices.condition, 4.0, 1e-14);
}

TEST(ObservabilityTest, OneParameterHasItsColumnsNormAsSingularValue) {
  const ObservabilityIndices indices =
      ComputeObservability(Eigen::MatrixXd::Constant(4, 1, 3.0), 9);
  EXPECT_NEAR(indices.o1, 2.0, 1e-14);  // 6 / sqrt(9)
  EXPECT_EQ(indices.o2, 1.0);
  EXPECT_NEAR(indices.o3, 6.0, 1e-14);
  EXPECT_NEAR(indices.o4, 6.0, 1e-14);
  EXPECT_NEAR(indices.o5, 6.0, 1e-14);
  EXPECT_EQ(indices.condition, 1.0);
}

TEST(ObservabilityTest, ShortRankHasZeroIndices) {
  const Eigen::Vector3d s(8.0, 4.0, 0.0);
  const ObservabilityIndices indices =
      ComputeObservability(Eigen::MatrixXd(s.asDiagonal()), 16);
  EXPECT_EQ(indices.o1, 0.0);
  EXPECT_EQ(indices.o5, 0.0);
  EXPECT_TRUE(std::isinf(indices.condition));
}

TEST(PredictDeviationsTest, MatchesTheInverseOfTheInformationMatrix) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(4, 4);
  factor << 3, 1, -2, 0.5, 0, 2, 0.3, 1, 0, 0, 1.5, -0.7, 0, 0, 0, 0.9;
  Eigen::VectorXd prior(4);
  prior << 0.5, std::numeric_limits<double>::infinity(), 2.0, 0.1;
  const Eigen::MatrixXd information =
      factor.transpose() * factor +
      Eigen::MatrixXd(prior.cwiseInverse().cwiseAbs2().asDiagonal());
  const Eigen::VectorXd expected = information.inverse().diagonal().cwiseSqrt();
  const Eigen::VectorXd deviations = PredictDeviations(factor, prior);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(deviations[k] / expected[k], 1.0, 1e-12);
  }
}

TEST(PredictDeviationsTest,
     UnidentifiableParametersAreInfiniteAndOthersAreNot) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(3, 3);
  factor << 2, 0, 0, 0, 1, 1, 0, 0, 0;
  const Eigen::VectorXd none =
      Eigen::VectorXd::Constant(3, std::numeric_limits<double>::infinity());
  const Eigen::VectorXd deviations = PredictDeviations(factor, none);
  EXPECT_NEAR(deviations[0], 0.5, 1e-14);
  EXPECT_TRUE(std::isinf(deviations[1]));
  EXPECT_TRUE(std::isinf(deviations[2]));
}

// Two columns of unit norm, all but parallel: singular values sqrt(2) and
// `ratio` times as much. Rounding leaves four digits of it.
Eigen::MatrixXd AllButParallel(double ratio) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(2, 2);
  factor << 1, 1, 0, 2.0 * ratio;
  return factor;
}

TEST(PredictDeviationsTest,
     DirectionsBelowATrillionthOfTheLargestAreUnidentifiable) {
  const Eigen::Vector2d none =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isinf(PredictDeviations(AllButParallel(0.8e-12), none)[0]));
  const double deviation = PredictDeviations(AllButParallel(1.25e-12), none)[0];
  EXPECT_NEAR(deviation * 2.5e-12, 1.0, 1e-2);
}

// A random matrix of `rows` x `columns`, its columns of the sizes that lengths
// and angles have: condition of some tens once they are of unit norm.
Eigen::MatrixXd RandomJacobian(int rows, int columns, Random* random) {
  Eigen::MatrixXd matrix(rows, columns);
  for (int c = 0; c < columns; ++c) {
    const double scale = std::pow(10.0, random->Uniform(-2.0, 2.0));
    for (int r = 0; r < rows; ++r) matrix(r, c) = scale * random->Normal();
  }
  return matrix;
}

// sqrt(trace(W (J^T J + P)^-1 W^T)) by dense normal equations in long double.
double OracleTotal(const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd& prior, const Eigen::MatrixXd& other) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix j = jacobian.cast<long double>();
  const Matrix w = other.cast<long double>();
  Matrix information = j.transpose() * j;
  for (Eigen::Index k = 0; k < prior.size(); ++k) {
    if (std::isinf(prior[k])) continue;
    const long double root = 1.0L / prior[k];
    information(k, k) += root * root;
  }
  const Matrix covariance = information.inverse();
  return static_cast<double>(
      std::sqrt((w * covariance * w.transpose()).trace()));
}

class PredictTotalTest : public ::testing::TestWithParam<bool> {};

TEST_P(PredictTotalTest, MatchesDenseNormalEquations) {
  constexpr int kColumns = 12;
  for (int draw = 0; draw < 20; ++draw) {
    Random random(91, draw);
    const Eigen::MatrixXd jacobian = RandomJacobian(40, kColumns, &random);
    const Eigen::MatrixXd other = RandomJacobian(25, kColumns, &random);
    Eigen::VectorXd prior = Eigen::VectorXd::Constant(
        kColumns, std::numeric_limits<double>::infinity());
    if (GetParam()) {
      // As wide as what the data tell, two of three.
      for (int k = 0; k < kColumns; ++k) {
        if (k % 3 == 2) continue;
        prior[k] = random.Uniform(0.1, 3.0) / jacobian.col(k).norm();
      }
    }
    const double expected = OracleTotal(jacobian, prior, other);
    // Rounding of the singular values, through a condition of some tens.
    EXPECT_NEAR(PredictTotal(jacobian, prior, other) / expected, 1.0, 1e-12);
    // Any factor of either will do.
    const Eigen::MatrixXd factor = jacobian.householderQr()
                                       .matrixQR()
                                       .topRows(kColumns)
                                       .triangularView<Eigen::Upper>();
    const Eigen::MatrixXd factor_of_other = other.householderQr()
                                                .matrixQR()
                                                .topRows(kColumns)
                                                .triangularView<Eigen::Upper>();
    EXPECT_NEAR(PredictTotal(factor, prior, factor_of_other) / expected, 1.0,
                1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(WithoutAndWithPriors, PredictTotalTest,
                         ::testing::Bool());

// Of the identity's rows the total is that of the deviations.
TEST(PredictTotalOfRowsTest, OfTheIdentityIsTheNormOfTheDeviations) {
  Random random(92);
  const Eigen::MatrixXd jacobian = RandomJacobian(20, 6, &random);
  const Eigen::VectorXd prior = Eigen::VectorXd::Constant(6, 0.5);
  const double expected = PredictDeviations(jacobian, prior).norm();
  // As above.
  EXPECT_NEAR(
      PredictTotal(jacobian, prior, Eigen::MatrixXd::Identity(6, 6)) / expected,
      1.0, 1e-12);
}

TEST(PredictTotalOfRowsTest,
     IsInfiniteOnlyWhereUnidentifiableDirectionsAreSeen) {
  const double infinity = std::numeric_limits<double>::infinity();
  // The sum of the second and third parameter is told, their difference not.
  Eigen::MatrixXd jacobian(2, 3);
  jacobian << 2.0, 0.0, 0.0, 0.0, 1.0, 1.0;
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(infinity);
  const Eigen::RowVector3d difference(0.0, 1.0, -1.0);
  EXPECT_EQ(PredictTotal(jacobian, none, difference), infinity);
  EXPECT_EQ(PredictTotal(jacobian, none, Eigen::RowVector3d(0, 0, 1)),
            infinity);
  // In whatever unit.
  EXPECT_EQ(PredictTotal(jacobian, none, 1e-4 * difference), infinity);
  EXPECT_NEAR(PredictTotal(jacobian, none, Eigen::RowVector3d(0, 3e4, 3e4)),
              3e4, 1e-9);
  // Numbers without rounding but that of the decomposition.
  EXPECT_NEAR(PredictTotal(jacobian, none, Eigen::RowVector3d(1, 0, 0)), 0.5,
              1e-14);
  EXPECT_NEAR(PredictTotal(jacobian, none, Eigen::RowVector3d(0, 3, 3)), 3.0,
              1e-13);
  // A prior tells the rest: of b + c = 0 +- 1 and c = 0 +- 0.1, b - c is
  // (b + c) - 2 c, of variance 1 + 0.04.
  const Eigen::Vector3d of_third(infinity, infinity, 0.1);
  EXPECT_NEAR(PredictTotal(jacobian, of_third, difference), std::sqrt(1.04),
              1e-13);
}

TEST(PredictTotalOfRowsTest, AParameterWithoutAnyEffectMatters) {
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd jacobian(2, 2);
  jacobian << 4.0, 0.0, 3.0, 0.0;
  const Eigen::Vector2d none = Eigen::Vector2d::Constant(infinity);
  // Standard deviation of the first: 1 / 5.
  EXPECT_NEAR(PredictTotal(jacobian, none, Eigen::RowVector2d(1, 0)), 0.2,
              1e-14);
  EXPECT_EQ(PredictTotal(jacobian, none, Eigen::RowVector2d(0, 1)), infinity);
  EXPECT_EQ(PredictTotal(Eigen::MatrixXd(0, 0), Eigen::VectorXd(),
                         Eigen::MatrixXd(0, 0)),
            0.0);
}

}  // namespace
}  // namespace alidade::internal
