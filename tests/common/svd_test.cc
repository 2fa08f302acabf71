#include "src/common/svd.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
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

}  // namespace
}  // namespace alidade::internal
