#include "src/common/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "src/common/constants.h"

namespace alidade::internal::distributions_test {
namespace {

void ExpectRelative(double actual, double expected, double tolerance) {
  EXPECT_NEAR(actual, expected, tolerance * std::abs(expected));
}

// Reference values: bisection in 50 decimal digits. Tolerances: a few hundred
// roundings of terms and exponents.
TEST(DistributionsTest, NormalQuantilesAgreeWithHighPrecision) {
  ExpectRelative(NormalQuantile(1e-300), -37.0470962993611992, 1e-13);
  ExpectRelative(NormalQuantile(1e-12), -7.03448382530113193, 1e-13);
  ExpectRelative(NormalQuantile(0.025), -1.95996398454005424, 1e-13);
  ExpectRelative(NormalQuantile(0.3), -0.524400512708040784, 1e-13);
  ExpectRelative(NormalQuantile(0.975), 1.95996398454005424, 1e-13);
  EXPECT_EQ(NormalQuantile(0.0), -kInfinity);
  EXPECT_EQ(NormalQuantile(1.0), kInfinity);
}

TEST(DistributionsTest, StudentTQuantilesAgreeWithHighPrecision) {
  ExpectRelative(StudentTQuantile(0.975, 1.0), 12.7062047361747046, 1e-12);
  ExpectRelative(StudentTQuantile(0.975, 2.0), 4.30265272974946385, 1e-12);
  ExpectRelative(StudentTQuantile(0.975, 5.0), 2.57058183563631551, 1e-12);
  ExpectRelative(StudentTQuantile(0.95, 38.5), 1.68540761169584059, 1e-12);
  ExpectRelative(StudentTQuantile(0.025, 150.0), -1.97590533089662052, 1e-12);
  ExpectRelative(StudentTQuantile(0.6, 3.0), 0.276670662332689911, 1e-12);
  EXPECT_EQ(StudentTQuantile(0.9, kInfinity), NormalQuantile(0.9));
}

// The expansion in 1 / dof: t = z + (z^3 + z) / (4 dof) + O(1 / dof^2).
TEST(DistributionsTest, StudentTGoesToTheNormal) {
  const double z = NormalQuantile(0.975);
  const double dof = 1e6;
  ExpectRelative(StudentTQuantile(0.975, dof),
                 z + (z * z * z + z) / (4.0 * dof), 1e-8);
}

TEST(DistributionsTest, FisherQuantilesAgreeWithHighPrecision) {
  ExpectRelative(FisherQuantile(0.95, 3.0, 10.0), 3.70826481904684449, 1e-12);
  ExpectRelative(FisherQuantile(0.95, 3.0, 150.0), 2.66490696961310941, 1e-12);
  ExpectRelative(FisherQuantile(0.99, 6.0, 38.5), 3.31180466120242953, 1e-12);
  ExpectRelative(FisherQuantile(0.01, 3.0, 20.0), 0.0374675102684307672, 1e-12);
  // Without end it is chi-square over its degrees of freedom: exponential for
  // two.
  ExpectRelative(FisherQuantile(0.95, 2.0, kInfinity), -std::log(0.05), 1e-12);
}

TEST(DistributionsTest, RateIntervalIsThatOfClopperAndPearson) {
  const auto [lower, upper] = RateInterval(9500, 10000, 0.95);
  ExpectRelative(lower, 0.945545472971641136, 1e-9);
  ExpectRelative(upper, 0.954190057801229395, 1e-9);
  const auto [few, most] = RateInterval(1, 10, 0.95);
  ExpectRelative(few, 0.0025285785444617845, 1e-11);
  ExpectRelative(most, 0.44501611702819542, 1e-11);
  // None of n: 1 - (1 - confidence over 2)^(1 / n).
  EXPECT_EQ(RateInterval(0, 20, 0.95).first, 0.0);
  ExpectRelative(RateInterval(0, 20, 0.95).second,
                 1.0 - std::pow(0.025, 1.0 / 20.0), 1e-11);
  EXPECT_EQ(RateInterval(20, 20, 0.95).second, 1.0);
  EXPECT_EQ(RateInterval(0, 0, 0.95).second, 1.0);
}

}  // namespace
}  // namespace alidade::internal::distributions_test
