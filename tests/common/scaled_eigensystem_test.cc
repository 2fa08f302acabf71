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
  Eigen::MatrixXd a = RandomSymmetric(3, 3, 1.0);
  a(1, 1) = kNan;
  EXPECT_FALSE(ScaledEigensystem(a).Root().allFinite());
}

}  // namespace
}  // namespace alidade::internal
