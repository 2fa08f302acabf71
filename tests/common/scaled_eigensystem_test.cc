#include "src/common/scaled_eigensystem.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "src/common/constants.h"
#include "src/common/random.h"

namespace alidade::internal {
namespace {

// B B^T with rows in units that differ by `units` from one to the next.
Eigen::MatrixXd RandomSymmetric(int size, int rank, double units) {
  Random random(5);
  Eigen::MatrixXd b(size, rank);
  for (double& entry : b.reshaped()) entry = random.Normal();
  for (int row = 0; row < size; ++row) b.row(row) *= std::pow(units, row);
  return b * b.transpose();
}

// What is left of `matrix - wanted`, each entry by its units.
double Difference(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& wanted,
                  const Eigen::VectorXd& units) {
  const Eigen::MatrixXd rest = matrix - wanted;
  return rest.cwiseQuotient(units * units.transpose()).cwiseAbs().maxCoeff();
}

TEST(ScaledEigensystemTest, RootsReproduceTheMatrixInAnyUnits) {
  for (const double units : {1.0, 1e-3, 1e4}) {
    for (const int rank : {2, 6}) {
      const Eigen::MatrixXd a = RandomSymmetric(6, rank, units);
      const ScaledEigensystem system(a);
      const Eigen::MatrixXd root = system.Root();
      EXPECT_LT(Difference(root * root.transpose(), a, system.scale), 1e-13)
          << units << " " << rank;
    }
  }
}

TEST(ScaledEigensystemTest, PseudoInverseIsTheInverseWhereThereIsOne) {
  const Eigen::MatrixXd a = RandomSymmetric(5, 9, 1e-3);
  const ScaledEigensystem system(a);
  int rank = 0;
  const Eigen::MatrixXd inverse = system.PseudoInverse(1e-9, &rank);
  EXPECT_EQ(rank, 5);
  const Eigen::MatrixXd identity = system.scale.asDiagonal() * (inverse * a) *
                                   system.inverse_scale.asDiagonal();
  EXPECT_LT((identity - Eigen::MatrixXd::Identity(5, 5)).cwiseAbs().maxCoeff(),
            1e-12);
}

// Of two parameters that are nearly one, whose values are 2 and 1e-4.
TEST(ScaledEigensystemTest, LeastCountsAgainstAUnitDiagonal) {
  const double small = 1e-4;
  const Eigen::MatrixXd a =
      100.0 *
      (Eigen::Matrix2d() << 1.0, 1.0 - small, 1.0 - small, 1.0).finished();
  const ScaledEigensystem system(a);
  EXPECT_NEAR(system.values[0], small, 1e-14);
  EXPECT_NEAR(system.values[1], 2.0 - small, 1e-14);
  int rank = 0;
  system.PseudoInverse(0.9 * small, &rank);
  EXPECT_EQ(rank, 2);
  system.PseudoInverse(1.1 * small, &rank);
  EXPECT_EQ(rank, 1);
}

TEST(ScaledEigensystemTest, WhatHasNoVarianceHasNoRoot) {
  Eigen::MatrixXd a = RandomSymmetric(4, 4, 1.0);
  a.row(1).setZero();
  a.col(1).setZero();
  for (const double rounding : {0.0, -1e-18}) {
    a(1, 1) = rounding;
    const Eigen::MatrixXd root = ScaledEigensystem(a).Root();
    EXPECT_EQ(root.row(1).norm(), 0.0);
    EXPECT_LT((root * root.transpose() - a).cwiseAbs().maxCoeff(), 1e-14);
  }
}

// A A^+ A = A tells it from any other matrix of that rank but for what is left
// over on both sides; A^+ A A^+ = A^+ that nothing is.
TEST(ScaledEigensystemTest, PseudoInverseLeavesOutWhatIsNotThere) {
  Eigen::MatrixXd a = RandomSymmetric(6, 3, 1e-2);
  a.row(4).setZero();
  a.col(4).setZero();
  const ScaledEigensystem system(a);
  int rank = 0;
  const Eigen::MatrixXd inverse = system.PseudoInverse(1e-9, &rank);
  EXPECT_EQ(rank, 3);
  EXPECT_EQ(inverse.row(4).norm(), 0.0);
  const Eigen::VectorXd units =
      system.scale.unaryExpr([](double s) { return s > 0.0 ? s : 1.0; });
  EXPECT_LT(Difference(a * inverse * a, a, units), 1e-12);
  EXPECT_LT(Difference(inverse * a * inverse, inverse, units.cwiseInverse()),
            1e-10);
  EXPECT_EQ(system.PseudoInverse(1e9, &rank).norm(), 0.0);
  EXPECT_EQ(rank, 0);
}

TEST(ScaledEigensystemTest, EmptyAndNotFinite) {
  int rank = 1;
  const ScaledEigensystem empty(Eigen::MatrixXd(0, 0));
  EXPECT_EQ(empty.Root().size(), 0);
  EXPECT_EQ(empty.PseudoInverse(1e-9, &rank).size(), 0);
  EXPECT_EQ(rank, 0);
  for (const int size : {1, 3}) {
    Eigen::MatrixXd a = RandomSymmetric(size, size, 1.0);
    a(0, 0) = kNan;
    const ScaledEigensystem system(a);
    EXPECT_FALSE(system.Root().allFinite());
    EXPECT_FALSE(system.PseudoInverse(1e-9, &rank).allFinite());
  }
}

}  // namespace
}  // namespace alidade::internal
