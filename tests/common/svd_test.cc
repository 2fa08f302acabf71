#include "src/common/svd.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "src/common/random.h"

namespace alidade::internal {
namespace {

Eigen::MatrixXd RandomMatrix(int rows, int columns, Random* random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns,
                                      [&] { return random->Normal(); });
}

TEST(SvdTest, FactorsReproduceTheMatrixAndAreOrthonormal) {
  Random random(3);
  for (const auto& [rows, columns] : {std::pair(1, 1), std::pair(5, 5),
                                      std::pair(168, 17), std::pair(9, 8)}) {
    const Eigen::MatrixXd a = RandomMatrix(rows, columns, &random);
    const Svd svd = ComputeSvd(a);
    const Eigen::MatrixXd identity =
        Eigen::MatrixXd::Identity(columns, columns);
    EXPECT_LT((svd.u * svd.values.asDiagonal() * svd.v.transpose() - a)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-13);
    EXPECT_LT((svd.u.transpose() * svd.u - identity).cwiseAbs().maxCoeff(),
              1e-14 * rows);
    EXPECT_LT((svd.v.transpose() * svd.v - identity).cwiseAbs().maxCoeff(),
              1e-14 * rows);
    for (int i = 1; i < columns; ++i) {
      EXPECT_LE(svd.values[i], svd.values[i - 1]);
    }
  }
}

TEST(SvdTest, SingularValuesOfKnownMatrices) {
  Eigen::MatrixXd a(3, 2);
  a << 3, 0, 0, 4, 0, 0;
  EXPECT_NEAR(SingularValues(a)[0], 4.0, 1e-15);
  EXPECT_NEAR(SingularValues(a)[1], 3.0, 1e-15);
  EXPECT_NEAR(SingularValues(a.transpose())[1], 3.0, 1e-15);
  EXPECT_EQ(SingularValues(Eigen::MatrixXd(0, 0)).size(), 0);
  EXPECT_EQ(SingularValues(Eigen::MatrixXd::Zero(4, 2)).maxCoeff(), 0.0);
}

TEST(SvdTest, OfWhatIsNotFiniteIsNan) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e200}) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(5, 3);
    matrix(4, 1) = bad;
    matrix(2, 1) = bad;
    const Svd svd = ComputeSvd(matrix);
    ASSERT_EQ(svd.values.size(), 3);
    const Eigen::VectorXd values = SingularValues(matrix);
    if (bad == 1e200) {
      // Squares overflow: what comes out must say so or be right.
      EXPECT_TRUE(std::isnan(svd.values[0]) || svd.values[0] >= 1e200);
      continue;
    }
    EXPECT_TRUE(std::isnan(svd.values[0]));
    EXPECT_TRUE(std::isnan(values[0]));
    EXPECT_EQ(svd.u.rows(), 5);
    EXPECT_TRUE(std::isnan(svd.u(0, 0)));
  }
}

// Against the normal equations of what is kept, b = A x + c with c at right
// angles to A's columns: columns 1 and 2 are one, so that x has the same in
// both.
TEST(SolveByMinimumNormTest, IsTheShortestOfTheBest) {
  Random random(8);
  Eigen::MatrixXd a = RandomMatrix(9, 3, &random);
  a.col(2) = a.col(1);
  const Eigen::VectorXd b = RandomMatrix(9, 1, &random);
  const Eigen::VectorXd x = SolveByMinimumNorm(a, b, 1e-9);
  EXPECT_LT((a.transpose() * (b - a * x)).norm(), 1e-13);
  EXPECT_NEAR(x[1], x[2], 1e-14);
  EXPECT_GT(std::abs(x[1]), 1e-3);
  // Numbers whose reciprocal is none count as zero.
  for (const double tiny : {0.0, 1e-310}) {
    EXPECT_EQ(SolveByMinimumNorm(Eigen::MatrixXd::Constant(4, 2, tiny),
                                 Eigen::VectorXd::Ones(4), 1e-9)
                  .norm(),
              0.0);
  }
}

// A column of 1e-3 counts by a tolerance on one side of it, not by one on the
// other.
TEST(SolveByMinimumNormTest, ToleranceIsAPartOfTheLargestValue) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3, 2);
  a(0, 0) = 100.0;
  a(1, 1) = 0.1;
  const Eigen::Vector3d b(100.0, 0.1, 5.0);
  EXPECT_LT(
      (SolveByMinimumNorm(a, b, 0.9e-3) - Eigen::Vector2d(1.0, 1.0)).norm(),
      1e-14);
  EXPECT_LT(
      (SolveByMinimumNorm(a, b, 1.1e-3) - Eigen::Vector2d(1.0, 0.0)).norm(),
      1e-14);
}

TEST(OrthonormalBasisTest, SpansTheColumnsOfAnyShape) {
  Random random(9);
  for (const auto& [rows, columns, rank] :
       {std::tuple(8, 3, 3), std::tuple(8, 5, 2), std::tuple(3, 6, 3)}) {
    const Eigen::MatrixXd left = RandomMatrix(rows, rank, &random);
    const Eigen::MatrixXd right = RandomMatrix(rank, columns, &random);
    const Eigen::MatrixXd a = left * right;
    const Eigen::MatrixXd basis = OrthonormalBasis(a, 1e-9);
    ASSERT_EQ(basis.cols(), rank);
    const Eigen::MatrixXd products = basis.transpose() * basis;
    EXPECT_LT((products - Eigen::MatrixXd::Identity(rank, rank)).norm(), 1e-13);
    const Eigen::MatrixXd shares = basis.transpose() * a;
    EXPECT_LT((basis * shares - a).norm(), 1e-12 * a.norm());
  }
  EXPECT_EQ(OrthonormalBasis(Eigen::MatrixXd::Zero(4, 2), 1e-9).cols(), 0);
  EXPECT_EQ(OrthonormalBasis(Eigen::MatrixXd(4, 0), 1e-9).rows(), 4);
  EXPECT_EQ(OrthonormalBasis(Eigen::MatrixXd(0, 3), 1e-9).size(), 0);
}

}  // namespace
}  // namespace alidade::internal
