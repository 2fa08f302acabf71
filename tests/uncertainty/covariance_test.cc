#include "src/uncertainty/covariance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "src/common/constants.h"
#include "src/kernel/reduction.h"
#include "src/solve/solve.h"
#include "tests/support/classic_arms.h"
#include "tests/support/noisy_positions.h"
#include "tests/support/reference_solution.h"
#include "tests/support/rv2aj_arms.h"
#include "tests/support/study.h"

namespace alidade::internal::covariance_test {
namespace {

using testing::MatrixXl;
using testing::VectorXl;

constexpr double kSigma = 0.02e-3;

struct Case {
  Arm arm;
  std::vector<int> columns;
  double prior;  // of every parameter (rad, m); infinite = none
};

std::vector<Case> Cases() {
  const Arm wrist = testing::Rv2ajWrist();
  const Arm flange = testing::Rv2ajFlange();
  std::vector<Case> cases = {
      {wrist, testing::WristFreeColumns(ParameterLayout(5)), 1e-3},
      {flange, testing::FlangeFreeColumns(ParameterLayout(5)), kInfinity}};
  for (const Arm& arm : {testing::Ur10(), testing::Panda()}) {
    const MeasurementModel model(arm);
    const Dataset data = testing::NoisyPositions(arm, 56, kSigma, 4);
    cases.push_back({arm, testing::TellableColumns(model, data), kInfinity});
  }
  return cases;
}

TEST(CovarianceTest, AgreesWithExtendedPrecision) {
  for (const Case& one : Cases()) {
    SCOPED_TRACE(one.arm.name);
    const MeasurementModel model(one.arm);
    const Dataset data = testing::NoisyPositions(one.arm, 56, kSigma, 4);
    const auto p = static_cast<Eigen::Index>(one.columns.size());
    const ParameterCovariance covariance = InverseInformation(
        JacobianFactor(model, model.NominalValues(), data, one.columns),
        one.columns, Eigen::VectorXd::Constant(p, one.prior));
    const MatrixXl reference = testing::ReferenceCovariance(
        testing::LinearizeReference(one.arm,
                                    model.NominalValues().cast<long double>(),
                                    data, one.columns)
            .jacobian,
        VectorXl::Constant(p, one.prior));
    const Eigen::MatrixXd matrix = covariance.Matrix();
    for (Eigen::Index a = 0; a < p; ++a) {
      for (Eigen::Index b = 0; b < p; ++b) {
        // The Jacobian's rounding, 1e-16, times the condition of up to 1e5,
        // times the same again for the square: far below what is asked, 1e-8.
        const auto unit =
            static_cast<double>(std::sqrt(reference(a, a) * reference(b, b)));
        EXPECT_NEAR(matrix(a, b), static_cast<double>(reference(a, b)),
                    1e-8 * unit);
      }
    }
    EXPECT_EQ(covariance.null_space.cols(), 0);
  }
}

TEST(CovarianceTest, WhatNothingTellsIsInfiniteAndTheRestIsNot) {
  // The second column repeats the first, the third is apart.
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(3, 3);
  factor << 2.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0;
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(3, kInfinity);
  const ParameterCovariance covariance =
      InverseInformation(factor, {0, 1, 2}, none);
  const Eigen::VectorXd deviations = covariance.Deviations();
  EXPECT_EQ(deviations[0], kInfinity);
  EXPECT_EQ(deviations[1], kInfinity);
  EXPECT_NEAR(deviations[2], 0.2, 1e-15);
  EXPECT_EQ(covariance.null_space.cols(), 1);
  // Rows of the factor see nothing of it, whatever the parameters' units.
  EXPECT_TRUE(covariance.AreTold(factor));
  EXPECT_FALSE(covariance.AreTold(Eigen::RowVector3d(1.0, 0.0, 0.0)));
  // With a prior on one of the two both are told: x1 by its prior, x2 by the
  // data given x1.
  Eigen::VectorXd prior = none;
  prior[0] = 3.0;
  const Eigen::VectorXd told =
      InverseInformation(factor, {0, 1, 2}, prior).Deviations();
  EXPECT_NEAR(told[0], 3.0, 1e-12);
  EXPECT_NEAR(told[1], std::sqrt(9.0 / 4.0 + 1.0 / 16.0), 1e-12);
}

TEST(CovarianceTest, AColumnOfZerosLeavesTheOthersAsTheyAre) {
  const Eigen::MatrixXd factor = Eigen::Vector3d(2.0, 0.0, 4.0).asDiagonal();
  const ParameterCovariance covariance = InverseInformation(
      factor, {0, 1, 2}, Eigen::VectorXd::Constant(3, kInfinity));
  const Eigen::VectorXd deviations = covariance.Deviations();
  EXPECT_NEAR(deviations[0], 0.5, 1e-15);
  EXPECT_EQ(deviations[1], kInfinity);
  EXPECT_NEAR(deviations[2], 0.25, 1e-15);
}

// The second column differs from the first by 1e-13, which may be rounding.
TEST(CovarianceTest, ColumnsThatDifferByRoundingAreUnidentifiable) {
  Eigen::Matrix2d factor;
  factor << 1.0, 1.0, 0.0, 1e-13;
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(2, kInfinity);
  EXPECT_EQ(InverseInformation(factor, {0, 1}, none).Deviations()[0],
            kInfinity);
  factor(1, 1) = 1e-9;
  // Rounding over the smallest part.
  EXPECT_NEAR(InverseInformation(factor, {0, 1}, none).Deviations()[0] * 1e-9,
              1.0, 1e-5);
}

TEST(ModelExcessTest, AddsToTheNoiseOfARowWhatItsKindLacks) {
  ModelExcess excess;
  EXPECT_FALSE(excess.is_there());
  EXPECT_DOUBLE_EQ(excess.RowVariance(5, 1e-4), 1.0);
  excess.length = 4e-8;
  EXPECT_TRUE(excess.is_there());
  excess.rotation = 9e-6;
  excess.noise_ratio = {1.5, 2.0};
  EXPECT_DOUBLE_EQ(excess.RowVariance(2, 1e-4), 1.5 + 4.0);
  EXPECT_DOUBLE_EQ(excess.RowVariance(3, 1e-3), 2.0 + 9.0);
  excess.length = 0.0;
  EXPECT_TRUE(excess.is_there());
}

TEST(CovarianceTest, EffectiveParametersCountWhatTheDataDecide) {
  const Eigen::MatrixXd factor = Eigen::Vector2d(1.0, 1.0).asDiagonal();
  const auto count = [&](double first, double second) {
    const Eigen::Vector2d prior(first, second);
    return EffectiveParameters(InverseInformation(factor, {0, 1}, prior),
                               prior);
  };
  EXPECT_NEAR(count(kInfinity, kInfinity), 2.0, 1e-14);
  // As wide a prior as the data: half each.
  EXPECT_NEAR(count(1.0, kInfinity), 1.5, 1e-14);
  EXPECT_NEAR(count(1e-6, kInfinity), 1.0, 1e-11);
}

// For Gaussian residuals the losses are tuned to an asymptotic efficiency of
// 95 %: variances are those of least squares over 0.95, whatever the arm.
TEST(CovarianceTest, SandwichHasTheEfficiencyThatLossesAreTunedTo) {
  const Arm arm = testing::Rv2ajFlange();
  const MeasurementModel model(arm);
  const Dataset data = testing::NoisyPositions(arm, 20000, kSigma, 8);
  const std::vector<int> columns =
      testing::FlangeFreeColumns(ParameterLayout(5));
  const Eigen::VectorXd no_priors;
  const Eigen::VectorXd values = model.NominalValues();
  const std::vector<RobustLoss> squares;
  const Eigen::VectorXd least =
      CovarianceOf({model, data, columns, no_priors, squares, values})
          .Deviations();
  for (const LossKind loss :
       {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    const std::vector<RobustLoss> losses = TunedLosses(loss);
    const Eigen::VectorXd robust =
        CovarianceOf({model, data, columns, no_priors, losses, values})
            .Deviations();
    const Eigen::VectorXd ratio = robust.cwiseQuotient(least);
    // Means over 20 000 observations are within a percent.
    EXPECT_NEAR(ratio.mean(), 1.0 / std::sqrt(0.95), 0.012);
    EXPECT_NEAR(ratio.maxCoeff(), ratio.minCoeff(), 1e-9);
  }
}

}  // namespace
}  // namespace alidade::internal::covariance_test
