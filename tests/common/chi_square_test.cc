#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "src/common/constants.h"
#include "src/common/distributions.h"

namespace alidade::internal {
namespace {

void ExpectRelative(double actual, double expected, double tolerance) {
  EXPECT_NEAR(actual, expected, tolerance * std::abs(expected));
}

TEST(ChiSquareTest, TwoDegreesOfFreedomAreExponential) {
  for (const double x : {1e-12, 0.01, 1.0, 3.9, 4.1, 40.0, 1300.0}) {
    ExpectRelative(ChiSquareCdf(x, 2.0), -std::expm1(-0.5 * x), 1e-13);
    // exp turns the rounding of its argument, 650, into a relative error.
    ExpectRelative(ChiSquareSurvival(x, 2.0), std::exp(-0.5 * x), 1e-12);
  }
  for (const double p : {1e-300, 1e-9, 0.05, 0.5, 0.95}) {
    ExpectRelative(ChiSquareQuantile(p, 2.0), -2.0 * std::log1p(-p), 1e-13);
    ExpectRelative(ChiSquareUpperQuantile(p, 2.0), -2.0 * std::log(p), 1e-13);
  }
}

TEST(ChiSquareTest, OneDegreeOfFreedomIsASquaredNormal) {
  for (const double x : {1e-12, 0.01, 1.0, 2.9, 3.1, 40.0, 1300.0}) {
    ExpectRelative(ChiSquareCdf(x, 1.0), std::erf(std::sqrt(0.5 * x)), 1e-13);
    ExpectRelative(ChiSquareSurvival(x, 1.0), std::erfc(std::sqrt(0.5 * x)),
                   1e-12);
  }
}

// The power series of P summed in 420 decimal digits, and 1 - P.
TEST(ChiSquareTest, AgreesWithHighPrecision) {
  const struct {
    double x, dof, cdf, survival;
  } kReference[] = {
      {1e-08, 3, 2.65961519469737230e-13, 9.99999999999733991e-01},
      {0.25, 1, 3.82924922548026181e-01, 6.17075077451973764e-01},
      {5.5, 6, 5.18543295286983619e-01, 4.81456704713016381e-01},
      {40, 3, 9.99999989344909634e-01, 1.06550903342558611e-08},
      {60, 6, 9.99999999954989782e-01, 4.50101664801212382e-11},
      {20, 31, 6.41963792588455817e-02, 9.35803620741154418e-01},
      {90, 31, 9.99999883522166844e-01, 1.16477833124366984e-07},
      {300, 300, 5.10858229749359682e-01, 4.89141770250640318e-01},
      {350, 300, 9.75269202735612573e-01, 2.47307972643874205e-02},
      {150, 300, 1.68150840041920632e-14, 9.99999999999983236e-01},
      {9500, 10000, 1.64386164358822567e-04, 9.99835613835641124e-01},
      {10500, 10000, 9.99752052632010613e-01, 2.47947367989360869e-04},
  };
  for (const auto& row : kReference) {
    SCOPED_TRACE(row.x);
    // Rounding, of up to a few hundred terms and of exponents of a few tens.
    ExpectRelative(ChiSquareCdf(row.x, row.dof), row.cdf, 1e-13);
    ExpectRelative(ChiSquareSurvival(row.x, row.dof), row.survival, 1e-13);
    const bool is_lower = row.cdf < 0.5;
    ExpectRelative(is_lower ? ChiSquareQuantile(row.cdf, row.dof)
                            : ChiSquareUpperQuantile(row.survival, row.dof),
                   row.x, 1e-13);
  }
}

// Abramowitz and Stegun 1964, table 26.8: as many digits as it prints.
TEST(ChiSquareTest, UpperQuantilesOfPublishedTables) {
  EXPECT_NEAR(ChiSquareUpperQuantile(0.05, 1.0), 3.84146, 5e-6);
  EXPECT_NEAR(ChiSquareUpperQuantile(0.05, 3.0), 7.81473, 5e-6);
  EXPECT_NEAR(ChiSquareUpperQuantile(0.01, 3.0), 11.3449, 5e-5);
  EXPECT_NEAR(ChiSquareUpperQuantile(0.001, 6.0), 22.458, 5e-4);
  EXPECT_NEAR(ChiSquareUpperQuantile(0.95, 10.0), 3.94030, 5e-6);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 100.0), 124.342, 5e-4);
  EXPECT_NEAR(ChiSquareQuantile(0.5, 6.0), 5.34812, 5e-6);
}

TEST(ChiSquareTest, QuantilesInvertProbabilitiesInBothTails) {
  for (const double dof : {0.1, 0.5, 1.0, 3.0, 7.5, 31.9, 32.1, 1e3, 1e4}) {
    for (const double p : {1e-300, 1e-100, 1e-9, 0.01, 0.5, 0.50001, 0.99}) {
      SCOPED_TRACE(testing::Message() << "dof " << dof << ", p " << p);
      const double x = ChiSquareQuantile(p, dof);
      // Few degrees of freedom: x itself may be below the smallest double, for
      // which versions of Boost give zero or twice that one.
      constexpr double kSmallest = 4.0 * std::numeric_limits<double>::min();
      if (x > kSmallest) {
        ExpectRelative(ChiSquareCdf(x, dof), p, 1e-12);
      } else {
        EXPECT_GE(ChiSquareCdf(kSmallest, dof), p * (1.0 - 1e-12));
      }
      const double y = ChiSquareUpperQuantile(p, dof);
      ExpectRelative(ChiSquareSurvival(y, dof), p, 1e-12);
    }
  }
}

TEST(ChiSquareTest, BothSidesOfTheSwitchOfMethodsAgree) {
  for (const double dof : {0.7, 3.0, 50.0, 5e3}) {
    const double x = dof + 2.0;
    const double step = 1e-10 * x;
    // Across both steps the probability grows by no more than the density
    // there, below 0.5 sqrt(dof + 1) / x, times 2e-10 x.
    EXPECT_NEAR(ChiSquareCdf(x - step, dof), ChiSquareCdf(x + step, dof),
                2e-10 * std::sqrt(dof + 1.0));
    EXPECT_NEAR(ChiSquareCdf(x, dof) + ChiSquareSurvival(x, dof), 1.0, 1e-15);
  }
}

TEST(ChiSquareTest, EndsOfTheRange) {
  EXPECT_EQ(ChiSquareCdf(-1.0, 3.0), 0.0);
  EXPECT_EQ(ChiSquareSurvival(0.0, 3.0), 1.0);
  EXPECT_EQ(ChiSquareCdf(kInfinity, 3.0), 1.0);
  EXPECT_EQ(ChiSquareSurvival(kInfinity, 3.0), 0.0);
  EXPECT_EQ(ChiSquareSurvival(1e300, 3.0), 0.0);
  EXPECT_EQ(ChiSquareQuantile(0.0, 3.0), 0.0);
  EXPECT_EQ(ChiSquareQuantile(1.0, 3.0), kInfinity);
  EXPECT_EQ(ChiSquareUpperQuantile(0.0, 3.0), kInfinity);
  EXPECT_EQ(ChiSquareUpperQuantile(1.0, 3.0), 0.0);
}

}  // namespace
}  // namespace alidade::internal
