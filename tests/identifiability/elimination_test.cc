#include "src/identifiability/elimination.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade::internal {
namespace {

// Columns 0 and 1 are 1e-3 apart, and column 2 is their difference a thousand
// times over: in the order given 0 and 1 would stay.
Eigen::MatrixXd NearlyParallel() {
  Eigen::MatrixXd factor(3, 3);
  factor.col(0) << 1.0, 0.0, 0.0;
  factor.col(1) << 1.0, 1e-3, 0.0;
  factor.col(2) << 0.0, 1.0, 0.0;
  return factor;
}

TEST(EliminateTest, ExchangesColumnsUntilNoCoefficientIsLarge) {
  const Elimination found = Eliminate(NearlyParallel(), 1e-9);
  EXPECT_EQ(found.kept, (std::vector<int>{0, 2}));
  ASSERT_EQ(found.dependent.size(), 1U);
  EXPECT_EQ(found.dependent[0].index, 1);
  // Column 1 is column 0 and a thousandth of column 2, but for rounding.
  EXPECT_NEAR(found.dependent[0].coefficients[0], 1.0, 1e-14);
  EXPECT_NEAR(found.dependent[0].coefficients[1], 1e-3, 1e-14);
}

TEST(EliminateTest, ProtectedColumnsStay) {
  const Elimination found = Eliminate(NearlyParallel(), 1e-9, 2);
  EXPECT_EQ(found.kept, (std::vector<int>{0, 1}));
  ASSERT_EQ(found.dependent.size(), 1U);
  EXPECT_NEAR(found.dependent[0].coefficients[0], -1e3, 1e-8);
  // The first alone: the second may leave.
  EXPECT_EQ(Eliminate(NearlyParallel(), 1e-9, 1).kept,
            (std::vector<int>{0, 2}));
}

TEST(EliminateTest, KeepsTheOrderWhereNothingIsGained) {
  // Column 2 is the sum of the others: any two are as good.
  Eigen::MatrixXd factor(3, 3);
  factor.col(0) << 1.0, 0.0, 0.0;
  factor.col(1) << 0.0, 1.0, 0.0;
  factor.col(2) << 1.0, 1.0, 0.0;
  const Elimination found = Eliminate(factor, 1e-9);
  EXPECT_EQ(found.kept, (std::vector<int>{0, 1}));
}

// As r2, r3 and r4 of three axes that are nearly parallel, and two betas: any
// of the three may stay, so that the first one does, whichever left first.
TEST(EliminateTest, ReturnsToTheOrderAmongEquals) {
  Eigen::MatrixXd factor(3, 5);
  factor.col(0) << 0.5, 0.0, 0.0;  // so that it leaves first
  factor.col(1) << 1.0, 1e-3, 0.0;
  factor.col(2) << 1.0, 0.0, 2e-3;
  factor.col(3) << 0.0, 1.0, 0.0;
  factor.col(4) << 0.0, 0.0, 1.0;
  const Elimination found = Eliminate(factor, 1e-9);
  EXPECT_EQ(found.kept, (std::vector<int>{0, 3, 4}));
  // Column 4 has no part in column 1, nor column 3 in column 2: neither may
  // take its place.
  ASSERT_EQ(found.dependent.size(), 2U);
  const Eigen::Vector3d expected[] = {{2.0, 1e-3, 0.0}, {2.0, 0.0, 2e-3}};
  for (const DependentColumn& column : found.dependent) {
    // Rounding, through an exchange of coefficients of a thousand.
    EXPECT_LE((column.coefficients - expected[column.index - 1])
                  .cwiseAbs()
                  .maxCoeff(),
              1e-12)
        << column.index;
  }
}

// Every coefficient of a random matrix of low rank is bounded, whatever the
// order, and the dependent columns are what they say.
TEST(EliminateTest, CoefficientsAreBoundedAndReproduceTheColumns) {
  for (int draw = 0; draw < 50; ++draw) {
    std::srand(static_cast<unsigned>(draw));
    Eigen::MatrixXd factor =
        Eigen::MatrixXd::Random(9, 4) * Eigen::MatrixXd::Random(4, 9);
    factor.col(1) = factor.col(0) + 1e-4 * factor.col(1);
    const Elimination found = Eliminate(factor, 1e-10);
    ASSERT_EQ(found.kept.size(), 4U) << draw;
    for (const DependentColumn& column : found.dependent) {
      EXPECT_LE(column.coefficients.cwiseAbs().maxCoeff(), kLargestCoefficient);
      Eigen::VectorXd rest = factor.col(column.index);
      for (std::size_t k = 0; k < found.kept.size(); ++k) {
        rest -= column.coefficients[static_cast<Eigen::Index>(k)] *
                factor.col(found.kept[k]);
      }
      // Nine columns of size one, times coefficients of five, rounded.
      EXPECT_LT(rest.norm(), 1e-12) << draw;
    }
  }
}

}  // namespace
}  // namespace alidade::internal
