#include "alidade/accuracy.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "src/common/random.h"

namespace alidade::internal {
namespace {

// 1, 2 ... n in a mixed order.
Eigen::VectorXd FirstNumbers(int n) {
  Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(n, 1.0, n);
  Random random(801);
  for (int i = n - 1; i > 0; --i) {
    std::swap(numbers[i],
              numbers[static_cast<int>(random.Uniform(0.0, i + 1.0))]);
  }
  return numbers;
}

TEST(SummarizeErrorsTest, ClosedFormsOfTheFirstNumbers) {
  for (const int count : {2, 3, 4, 21, 100, 3600}) {
    const double n = count;
    const Accuracy accuracy = SummarizeErrors(FirstNumbers(count));
    EXPECT_EQ(accuracy.n, count);
    // Sums of the first n numbers and squares; some rounding of the sums.
    const double tolerance = 1e-13 * n;
    EXPECT_NEAR(accuracy.mean, (n + 1.0) / 2.0, tolerance);
    EXPECT_NEAR(accuracy.rms, std::sqrt((n + 1.0) * (2.0 * n + 1.0) / 6.0),
                tolerance);
    EXPECT_NEAR(accuracy.stddev, std::sqrt(n * (n + 1.0) / 12.0), tolerance);
    EXPECT_NEAR(accuracy.median, (n + 1.0) / 2.0, tolerance);
    // Linear between order statistics: position 0.95 (n - 1) from the first.
    EXPECT_NEAR(accuracy.p95, 1.0 + 0.95 * (n - 1.0), tolerance);
    EXPECT_EQ(accuracy.min, 1.0);
    EXPECT_EQ(accuracy.max, n);
  }
}

TEST(SummarizeErrorsTest, OfNothingIsZero) {
  const Accuracy accuracy = SummarizeErrors(Eigen::VectorXd());
  EXPECT_EQ(accuracy.n, 0);
  EXPECT_EQ(accuracy.mean, 0.0);
  EXPECT_EQ(accuracy.rms, 0.0);
  EXPECT_EQ(accuracy.stddev, 0.0);
  EXPECT_EQ(accuracy.median, 0.0);
  EXPECT_EQ(accuracy.p95, 0.0);
  EXPECT_EQ(accuracy.min, 0.0);
  EXPECT_EQ(accuracy.max, 0.0);
}

TEST(SummarizeErrorsTest, OfOneValueIsThatValue) {
  const Accuracy accuracy =
      SummarizeErrors(Eigen::VectorXd::Constant(1, 0.0025));
  EXPECT_EQ(accuracy.n, 1);
  EXPECT_EQ(accuracy.mean, 0.0025);
  EXPECT_EQ(accuracy.rms, 0.0025);
  EXPECT_EQ(accuracy.stddev, 0.0);
  EXPECT_EQ(accuracy.median, 0.0025);
  EXPECT_EQ(accuracy.p95, 0.0025);
  EXPECT_EQ(accuracy.min, 0.0025);
  EXPECT_EQ(accuracy.max, 0.0025);
}

TEST(SummarizeErrorsTest, OfEqualValuesHasNoSpread) {
  // A power of two: sums and squares are exact.
  const Accuracy accuracy =
      SummarizeErrors(Eigen::VectorXd::Constant(16, 0.25));
  EXPECT_EQ(accuracy.mean, 0.25);
  EXPECT_EQ(accuracy.rms, 0.25);
  EXPECT_EQ(accuracy.stddev, 0.0);
  EXPECT_EQ(accuracy.median, 0.25);
  EXPECT_EQ(accuracy.p95, 0.25);
  EXPECT_EQ(accuracy.min, 0.25);
  EXPECT_EQ(accuracy.max, 0.25);
}

TEST(SummarizeErrorsTest, TheMedianIsNotTheMean) {
  const Accuracy accuracy =
      SummarizeErrors(Eigen::Vector4d(7.0, 0.0, 2.0, 1.0));
  EXPECT_DOUBLE_EQ(accuracy.median, 1.5);
  EXPECT_DOUBLE_EQ(accuracy.mean, 2.5);
  // Position 2.85 of 0, 1, 2, 7.
  EXPECT_DOUBLE_EQ(accuracy.p95, 2.0 + 0.85 * 5.0);
}

TEST(SummarizeErrorsTest, TheSpreadOfTinyErrorsSurvives) {
  // Errors at the numerical precision limit: squares near 1e-32 must not be
  // lost to a difference of sums.
  const Accuracy accuracy =
      SummarizeErrors(Eigen::Vector3d(1e-16, 2e-16, 3e-16));
  EXPECT_NEAR(accuracy.stddev, 1e-16, 1e-30);
  EXPECT_NEAR(accuracy.rms, std::sqrt(14.0 / 3.0) * 1e-16, 1e-30);
}

}  // namespace
}  // namespace alidade::internal
